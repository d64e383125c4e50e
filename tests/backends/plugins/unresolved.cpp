// A plug-in that was not linked to its engine's library.
extern "C" {
int function_of_a_library_that_is_not_there();
int crossgait_engine_plugin() { return function_of_a_library_that_is_not_there(); }
}
