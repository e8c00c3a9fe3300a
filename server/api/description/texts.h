// Files of this folder, as they were when the program was built.
#pragma once

#include <string_view>

namespace mapweld::server {

std::string_view words_text();  // words.json
std::string_view docs_page();   // docs.html

}  // namespace mapweld::server
