// Serves an engine as a Python file does (docs/engines-in-processes.md), and does wrong what the file that it
// is handed says: "<request> <fault>". The engine is a robot that falls without turning.
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "backends/served_memory.h"
#include "physics/core/served_process.h"

namespace {

using namespace crossgait;

constexpr int kSocket = 3, kMemory = 4;

struct Server {
  std::byte* memory = nullptr;
  std::string request, fault;  // which goes wrong, and how
  double dt = 0, gravity = 0;
  int joints = 0;

  double* block(std::size_t place) const {
    return reinterpret_cast<double*>(memory + kServedNumbersAt) + place;
  }
  void set_text(const std::string& text) const {
    std::memcpy(memory + kServedTextAt, text.data(), text.size());
    reinterpret_cast<ServedHeader*>(memory)->text_size = text.size();
  }
  std::string text() const {
    return {reinterpret_cast<const char*>(memory) + kServedTextAt,
            reinterpret_cast<const ServedHeader*>(memory)->text_size};
  }

  void hello() const {
    nlohmann::json said{{"protocol", kServedVersion},
                        {"library", "Falls"},
                        {"version", "1"},
                        {"laws", {{"contact", "none"}}},
                        {"answers", {"contacts", "mass_matrix"}}};
    if (fault == "protocol") said["protocol"] = 99;
    if (fault == "unknown key") said["laws"]["contacts"] = "none";
    if (fault.starts_with("equations")) said["equations"] = true;
    if (fault == "equations, its own dynamics") said["own_dynamics"] = true;
    if (fault == "precision") said["capabilities"] = {{"precision", "float16"}};
    constexpr std::size_t kDeep = 200'000;
    set_text(fault == "no json"     ? "{"
             : fault == "deep json" ? std::string(kDeep, '[') + std::string(kDeep, ']')
                                    : said.dump());
  }
  void make() {
    const auto world = nlohmann::json::parse(text());
    dt = world["physics_dt"];
    gravity = world["gravity"][2];
    joints = static_cast<int>(world["robot"]["bodies"].size()) - 1;
  }
  void answer(ServedRequest what) {
    double* state = block(served_block("state"));
    if (what == ServedRequest::kHello) hello();
    if (what == ServedRequest::kMake) make();
    if (what == ServedRequest::kReset)
      std::memcpy(state, block(served_block("asked_state")),
                  sizeof(double) * (13 + 2 * static_cast<std::size_t>(joints)));
    if (what == ServedRequest::kStep) {
      state[9] += dt * gravity;  // v_WB.z
      state[2] += dt * state[9];
    }
    if (what == ServedRequest::kMassMatrix) std::fill_n(block(served_block("answer")), 38 * 38, 1.0);
  }
};

[[noreturn]] void hang() {
  for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

// What is done instead of an answer, or on the way to it. @returns how many bytes of the answer to send
std::size_t do_wrong(Server& server, std::array<std::uint32_t, 4>& answer) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::string& fault = server.fault;
  if (fault == "exit") std::exit(7);
  if (fault == "kill") std::raise(SIGKILL);
  if (fault == "hang") hang();
  if (fault == "leave one" && fork() == 0) hang();
  if (fault == "leave one") std::exit(3);
  if (fault == "start one") static_cast<void>(fork()), hang();
  if (fault == "close") close(kSocket), hang();
  if (fault == "flood") {
    const std::string line(4095, 'x');
    for (;;)
      if (write(STDOUT_FILENO, (line + "\n").data(), 4096) < 0) std::exit(1);
  }
  if (fault == "error") server.set_text("ValueError: no such thing"), answer[1] = 1;
  if (fault == "long answer") return 16;
  if (fault == "short answer") return 3;
  if (fault == "another number") ++answer[0];
  if (fault == "cut off" && ftruncate(kMemory, 64) == 0) std::abort();  // which the seal must not let it
  if (fault == "text size") reinterpret_cast<ServedHeader*>(server.memory)->text_size = ~std::uint64_t{0};
  if (fault == "nan state") server.block(served_block("state"))[2] = kNaN;
  if (fault == "no attitude") server.block(served_block("state"))[3] = 5;
  if (fault == "many contacts") server.block(served_block("contact_counts"))[0] = 65;
  if (fault == "half a contact") server.block(served_block("contact_counts"))[0] = 0.5;
  if (fault == "nan contact" || fault == "no body") {
    server.block(served_block("contact_counts"))[0] = 1;
    const double contact[] = {0, -1, 0, 0, 0, 0, 0, 1, -1e-3, 0, 0, 1, 0};
    std::copy(std::begin(contact), std::end(contact), server.block(served_block("contacts")));
    server.block(served_block("contacts"))[fault == "no body" ? 0 : 9] = fault == "no body" ? 99 : kNaN;
  }
  if (fault == "nan answer") server.block(served_block("answer"))[3] = kNaN;
  return 8;
}

ServedRequest request_of(const std::string& name) {
  if (name == "hello") return ServedRequest::kHello;
  if (name == "make") return ServedRequest::kMake;
  if (name == "reset") return ServedRequest::kReset;
  if (name == "mass_matrix") return ServedRequest::kMassMatrix;
  return ServedRequest::kStep;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2 || std::getenv(kServedVariable) == nullptr) return 2;
  Server server;
  std::ifstream file(arguments[count - 1]);
  file >> server.request;
  std::getline(file >> std::ws, server.fault);
  if (server.request == "start") {
    std::array<std::uint32_t, 4> none{};
    do_wrong(server, none);
  }
  struct stat status {};
  fstat(kMemory, &status);
  server.memory = static_cast<std::byte*>(mmap(nullptr, static_cast<std::size_t>(status.st_size),
                                               PROT_READ | PROT_WRITE, MAP_SHARED, kMemory, 0));
  std::array<std::uint32_t, 2> asked{};
  while (recv(kSocket, asked.data(), sizeof asked, 0) == sizeof asked) {
    const auto what = static_cast<ServedRequest>(asked[1]);
    server.answer(what);
    std::array<std::uint32_t, 4> answer{asked[0], 0};
    std::size_t size = 8;
    if (what == request_of(server.request)) size = do_wrong(server, answer);
    send(kSocket, answer.data(), size, 0);
    if (server.fault == "twice" && what == ServedRequest::kReset) send(kSocket, answer.data(), size, 0);
  }
}
