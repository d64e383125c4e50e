// Consent to code that files bring along: no file runs code unless its user meant it to.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace crossgait {

/// The environment variable with the folders, apart by colons, whose files may run code.
inline constexpr const char* kTrustVariable = "CROSSGAIT_TRUST";

/// Checks that a file may run the code that it holds, before that is run. It may if, links followed,
///  - it is the user's own: below the current folder, in no folder there that programs fill (its name begins
///    with a dot, or is site-packages or dist-packages), and owned by the user or by root; or
///  - it is in a trusted folder or below it.
/// Then it is said that the file runs code, once for each `runs`, on standard error unless
/// `set_consent_notice` says otherwise.
/// @param runs  what is about to happen: "xacro evaluates the Python in it"
/// @throws ConfigError naming the file and the words of consent, in every other case
void require_consent(const std::string& file, std::string_view runs);

/// Trusts the files of a folder and below it, in this process and those that it begins.
/// @throws ConfigError naming `source` if it is no folder
void trust_folder(const std::string& folder, const std::string& source);

/// Lists the folders whose files may run code, apart by colons.
std::string trusted_folders();

/// Says where `require_consent` says that a file runs code.
void set_consent_notice(std::function<void(const std::string& sentence)> say);

}  // namespace crossgait
