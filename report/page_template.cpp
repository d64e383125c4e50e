#include "report/page_template.h"

#ifdef CROSSGAIT_PAGE_FILE
// The assembler copies the file as it is: half a megabyte, which a compiler would take seconds to read as
// text.
asm(R"(
.section .rodata
.global crossgait_page_begin
.global crossgait_page_end
.hidden crossgait_page_begin
.hidden crossgait_page_end
crossgait_page_begin:
.incbin ")" CROSSGAIT_PAGE_FILE R"("
crossgait_page_end:
.text
)");
extern "C" {
extern const char crossgait_page_begin[];
extern const char crossgait_page_end[];
}
#endif

namespace crossgait {

std::string_view page_template() {
#ifdef CROSSGAIT_PAGE_FILE
  return {crossgait_page_begin, crossgait_page_end};
#else
  return {};
#endif
}

}  // namespace crossgait
