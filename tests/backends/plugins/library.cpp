// An engine's library in miniature, of version 1 or 2: the same symbols with different values.
extern "C" {
int test_library_version() { return LIBRARY_VERSION; }
int test_library_state = 0;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): what libraries do
}
