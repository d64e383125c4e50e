// A library that does to the process that opens it what CROSSGAIT_TEST_FAULT says, before anybody asks it
// anything.
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <unistd.h>

namespace {

struct Constructor {
  Constructor() {
    const char* const said = std::getenv("CROSSGAIT_TEST_FAULT");
    const std::string fault = said != nullptr ? said : "";
    if (fault == "exit") std::exit(0);
    if (fault == "_exit") ::_exit(0);
    if (fault == "abort") std::abort();
    if (fault == "throw") throw std::runtime_error("no licence");
    if (fault == "divide") ::feenableexcept(FE_DIVBYZERO);
    if (fault == "round") std::fesetround(FE_UPWARD);
    if (fault == "close") ::close(STDOUT_FILENO);
    if (fault == "stop") ::raise(SIGSTOP);
    while (fault == "wait") ::pause();
  }
};

const Constructor kConstructor;

}  // namespace

extern "C" void* crossgait_engine_plugin() { return nullptr; }
