// How a robot and the ground touch: what is simulated, and what users and files say of it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Holds the softness of a constraint, in MuJoCo's terms (MuJoCo manual, "Computation > Constraint model >
/// Parameters"). These are its defaults.
struct Softness {
  double time_constant = 0.02;  ///< s, at least two physics steps
  double damping_ratio = 1.0;
  double impedance_min = 0.9, impedance_max = 0.95, impedance_width = 0.001;  ///< -, -, m (rad)
  double impedance_midpoint = 0.5, impedance_power = 2;                       ///< -, -
};

/// Says what bounds friction of soft contacts.
enum class FrictionCone : unsigned char { kElliptic, kPyramidal };
/// Names a cone: "elliptic", "pyramidal".
std::string_view name(FrictionCone cone) noexcept;

/// Holds the contact *intent*. How each engine realises it is one documented function per engine
/// (backends/mujoco/model_xml.cpp, physics/engine/soft_law.h, backends/bullet/native_contact.cpp).
struct ContactSpec {
  double friction = 0.6;              ///< Coulomb coefficient between robot and terrain
  double torsional_friction = 0.005;  ///< m, against turning about the normal; counts from condim 4 on
  double rolling_friction = 0.0001;   ///< m, against rolling; counts from condim 6 on
  int condim = 3;                     ///< dimensions of a contact: 3, 4 (torsion) or 6 (and rolling)
  double impratio = 1.0;              ///< MuJoCo's ratio of frictional to normal impedance
  FrictionCone cone = FrictionCone::kElliptic;
  Softness softness;  ///< of the contact normal; hard contacts ignore it

  // Of hard contact; soft contacts ignore them. Bullet's defaults (btContactSolverInfo: m_erp2, m_globalCfm),
  // but that Bullet bounds no speed: a foot that finds itself 20 mm in the ground would be thrown out at 4
  // m/s. 0.3 m/s is a fall from 5 mm; at a step of 1 ms it is met by penetrations beyond 1.5 mm, which no
  // foot reaches that was above the ground before.
  double erp = 0.2;                         ///< share of a penetration that is undone in a step
  double max_depenetration_velocity = 0.3;  ///< at which it is undone at most, m/s
  double cfm = 0;                           ///< added to each row's response to itself, as a share of it
};

/// Is a setting of contact by name. Its value is one number or several; of `cone` the place among its words.
struct ContactSetting {
  std::string_view name;  ///< as in YAML, options and results, and where MuJoCo has it as in MJCF
  std::string_view unit;
  std::string_view help;
  std::size_t least = 1, most = 1;          ///< numbers
  std::span<const std::string_view> words;  ///< in the place of a number
  std::vector<double> (*get)(const ContactSpec&);
  void (*set)(ContactSpec&, std::span<const double>);  ///< numbers that are not given stay as they are
};
std::span<const ContactSetting> contact_settings();
/// @throws ConfigError naming `source`, listing the names
const ContactSetting& find_contact_setting(std::string_view name, std::string_view source);

/// Holds what is said of contact; what is not said is empty. By the places of `contact_settings`.
struct ContactSettings {
  std::vector<std::optional<std::vector<double>>> said;

  bool is_empty() const noexcept;
  /// Returns the numbers of a setting; null where it is not said.
  const std::vector<double>* find(std::string_view name) const;
  /// Checks number and range. @param source,element  for messages  @throws ConfigError
  void set(std::string_view name, std::vector<double> numbers, std::string_view source,
           std::string_view element);
  /// Sets a setting from text: a word, or numbers with blanks or colons between them, "0.005:1".
  void set(std::string_view name, std::string_view text, std::string_view source, std::string_view element);
  /// Takes over what `other` says.
  void add(const ContactSettings& other);
  void apply(ContactSpec& contact) const;
};

/// Reads "impratio=100,solref=0.005:1,cone=pyramidal". @throws ConfigError naming `source`, also for a
/// setting that is given twice
ContactSettings parse_contact_settings(std::string_view text, std::string_view source);
/// Returns settings of that friction and nothing else. @throws ConfigError
ContactSettings friction_of(double coefficient);
/// Returns every setting of a contact, said, but for friction of which its condim makes nothing.
ContactSettings all_settings(const ContactSpec& contact);
/// How much there may be to ask for.
inline constexpr double kMostImpratio = 1000, kMostFriction = 10, kMostDepenetrationVelocity = 100;  // m/s
/// Writes the value as `parse_contact_settings` reads it.
std::string contact_setting_text(const ContactSetting& setting, std::span<const double> numbers);

/// Returns what is simulated: `asked` over `of_robot` over the defaults.
/// @throws ConfigError naming `source` where `asked` says torsional or rolling friction of which condim makes
/// nothing
ContactSpec resolve_contact(const ContactSettings& of_robot, const ContactSettings& asked,
                            std::string_view source);
/// Resolves them with the time constant that steps of `physics_dt` (s) have (time_constant_in_steps).
/// @throws ConfigError as `resolve_contact`
ContactSpec simulated_contact(const ContactSettings& of_robot, const ContactSettings& asked,
                              double physics_dt, std::string_view source);

/// Returns the time constant that MuJoCo's law has in steps of `physics_dt`, s: two of them at least.
double time_constant_in_steps(double time_constant, double physics_dt) noexcept;

/// Reads MuJoCo's numbers, solref in either form.
Softness softness_of(std::span<const double> solref, std::span<const double> solimp);

/// @param element  whose it is, for the message: "contact.softness"
/// @throws ConfigError naming `source` and the member
void validate_softness(const Softness& softness, std::string_view source, std::string_view element);

/// @throws ConfigError naming `source` and the setting
void validate_contact(const ContactSpec& contact, std::string_view source);

}  // namespace crossgait
