// A program of its own that answers requests, one at a time, through memory that both see.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

namespace crossgait {

/// Begins the memory that both sides see: first what this is, then text, then whatever the two agree on.
struct ServedHeader {
  std::uint64_t magic = 0x5652455347535243;  ///< "CRSGSERV"
  std::uint64_t version = 1;                 ///< of the protocol; an answer to another is refused
  std::uint64_t text_size = 0;               ///< bytes of `text` that are in use
};
inline constexpr std::uint64_t kServedVersion = ServedHeader().version;
/// Where the text begins, and how much of it there may be, bytes.
inline constexpr std::size_t kServedTextAt = 64, kServedText = std::size_t{4} << 20;
/// Where the numbers begin, bytes.
inline constexpr std::size_t kServedNumbersAt = kServedTextAt + kServedText;

/// Says on which descriptors a served program finds, apart by colons, the socket of requests, the memory, and
/// a pipe that is closed when the program that it serves is gone.
inline constexpr const char* kServedVariable = "CROSSGAIT_SERVES";

/// How long any answer may take, s, unless the environment variable of this name says otherwise.
inline constexpr const char* kServedLimitVariable = "CROSSGAIT_ENGINE_TIMEOUT";
inline constexpr double kServedLimit = 60;
/// Reads that variable. @throws ConfigError naming it
std::chrono::duration<double> served_limit();

/// Runs a program that answers requests. A request and its answer are eight bytes each on a socket (number of
/// the request; what is asked, or whether it was done); all else is in the memory. Whatever the program does
/// instead of answering is found out and ends it: ending, closing the socket, taking too long, or a second
/// where the caller is to end (`interruption_came`), writing more than `kMostOutput` within one request,
/// answering what was not asked. What it writes to its outputs is kept for the message. The program and what
/// it started (its process group) are ended when this object is, and by the system when this process is.
class ServedProcess {
 public:
  /// Bytes that a program may write to its outputs within one request.
  static constexpr std::size_t kMostOutput = std::size_t{1} << 20;

  /// @param source  what is served, for messages: a file
  /// @param command  the program, looked for as a shell does, and its arguments
  /// @param numbers  bytes of memory behind kServedNumbersAt
  /// @throws ConfigError if there is no such program, std::system_error if it cannot be run
  ServedProcess(std::string source, const std::vector<std::string>& command, std::size_t numbers,
                std::chrono::duration<double> limit);
  ~ServedProcess();
  ServedProcess(const ServedProcess&) = delete;
  ServedProcess& operator=(const ServedProcess&) = delete;

  /// Asks for `what` and waits for the answer. Allocates nothing unless it fails, which `throw_if_lost`
  /// tells.
  /// @param name  of the request, for messages; outlives this object
  bool request(std::uint32_t what, const char* name) noexcept;
  /// @throws ConfigError naming the source and the request, once one has failed; Interrupted, where it was
  /// given up since the caller is to end
  void throw_if_lost() const;
  bool is_lost() const noexcept { return !failure_.empty(); }
  /// Takes the program to be lost for a reason of the caller's: an answer without sense. Ends it.
  void lose(const char* request, const std::string& expected, const std::string& found) noexcept;

  /// Returns the text as it is now. @throws ConfigError if its size has no sense
  std::string_view text() const;
  /// @throws ConfigError if it is too long
  void set_text(std::string_view text);
  std::span<std::byte> numbers() noexcept { return {memory_ + kServedNumbersAt, numbers_}; }

  pid_t id() const noexcept { return child_; }
  /// Tells whether this is a fork of the process that started the program, and so may not ask it anything.
  bool is_of_another_process() const noexcept;

 private:
  void start(const std::vector<std::string>& command, int socket, int lifeline, int output);
  bool wait(std::uint32_t number, const char* name);
  bool read_answer(std::uint32_t number, const char* name);
  bool drain(std::size_t& written);
  std::string how_it_ended();
  void end() noexcept;

  std::string source_;
  std::chrono::duration<double> limit_;
  std::size_t numbers_;
  std::byte* memory_ = nullptr;
  int memory_file_ = -1, socket_ = -1, lifeline_ = -1, output_ = -1;
  pid_t child_ = -1, owner_ = -1;
  std::uint32_t requests_ = 0;
  std::string output_end_;  ///< the last of what it wrote
  bool interrupted_ = false;
  std::string failure_, failed_request_, expected_;
};

}  // namespace crossgait
