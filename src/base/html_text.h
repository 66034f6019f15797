// Small pieces of HTML.
#pragma once

#include <string>
#include <string_view>

namespace livecap {

// &, <, > and quotes as entities.
std::string html_escaped(std::string_view text);

std::string base64(std::string_view bytes);

// <img> with the picture inside the page. type: "png" or "jpeg".
std::string inline_image(const std::string& bytes, const char* type, const std::string& alternative_text);

}  // namespace livecap
