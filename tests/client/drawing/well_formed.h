// Is a text well-formed XML, as far as the figures use it? Elements, attributes, character data, the five entities.
#pragma once

#include <string>
#include <string_view>

namespace mapweld::testing {

// "" when it is; else what is wrong and where.
std::string xml_fault(std::string_view text);

// How many elements of this name begin.
std::size_t count_elements(std::string_view text, std::string_view name);

// The text of the element of this class: from its start tag to the end tag that closes it ("" when there is none).
std::string_view element_of_class(std::string_view text, std::string_view class_name);

}  // namespace mapweld::testing
