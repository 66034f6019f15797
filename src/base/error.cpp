#include "livecap/error.h"

#include <algorithm>

namespace livecap {
namespace {

// Bytes of the UTF-8 letter at the front of text; 0 when there is none: cut short, longer than it must be, or of no
// character (Unicode 15, table 3-7).
size_t letter_size(std::string_view text) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto is_between = [](unsigned value, unsigned low, unsigned high) { return value >= low && value <= high; };
  const unsigned first = byte(0),
                 low = first == 0xe0   ? 0xa0
                       : first == 0xf0 ? 0x90
                                       : 0x80,
                 high = first == 0xed   ? 0x9f
                        : first == 0xf4 ? 0x8f
                                        : 0xbf;
  if (first < 0x80) return 1;
  if (!is_between(first, 0xc2, 0xf4) || !is_between(byte(1), low, high)) return 0;
  const size_t size = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  for (size_t i = 2; i < size; ++i) {
    if (!is_between(byte(i), 0x80, 0xbf)) return 0;
  }
  return size;
}

bool is_control(std::string_view letter) {
  const auto first = static_cast<unsigned char>(letter[0]);
  if (letter.size() == 1) return first < ' ' || first == 0x7f;
  return letter.size() == 2 && first == 0xc2 && static_cast<unsigned char>(letter[1]) < 0xa0;  // C1
}

}  // namespace

std::string one_line(std::string_view text, size_t most) {
  std::string line;
  while (!text.empty()) {
    const size_t size = letter_size(text);
    const std::string_view letter = size == 0 || is_control(text.substr(0, size)) ? "?" : text.substr(0, size);
    if (line.size() + letter.size() > most) break;
    line += letter;
    text.remove_prefix(std::max<size_t>(size, 1));
  }
  return line;
}

}  // namespace livecap
