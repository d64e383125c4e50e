#include "apps/interruption.h"

#include <array>
#include <csignal>

#include "physics/core/interruption.h"
#include "physics/core/progress.h"

namespace crossgait::apps {
namespace {

extern "C" void remember_interruption(int) { interruption_is_asked = true; }

}  // namespace

void listen_for_interruption() {
  for (const int signal : std::array{SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler != SIG_DFL) continue;
    struct sigaction action {};
    action.sa_handler = remember_interruption;
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
  }
}

void check_interruption() {
  if (interruption_is_asked) throw Interrupted();
}

}  // namespace crossgait::apps
