// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "well_formed.hpp"

#include <cctype>
#include <vector>

namespace swarm::monitor {

std::size_t count_of(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string_view::npos;
       at = text.find(word, at + word.size())) {
    ++count;
  }
  return count;
}

std::string xml_fault(std::string_view text) {
  for (const char* bad : {"\"nan", "\"-nan", "\"inf", "\"-inf", ",nan", ",-nan", ",inf", ",-inf"}) {
    if (count_of(text, bad) > 0) return std::string("holds ") + bad;
  }
  std::vector<std::string> open;
  while (!text.empty()) {
    if (text[0] == '&' && text.substr(0, 8).find(';') == std::string_view::npos) {
      return "a bare & before " + std::string(text.substr(0, 20));
    }
    if (text[0] == '>') return "a bare >";
    if (text[0] != '<') {
      text.remove_prefix(1);
      continue;
    }
    // To the end of the tag, past quoted values.
    std::size_t end = 1;
    for (bool quoted = false; end < text.size() && (quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') quoted = !quoted;
      if (text[end] == '<') return "a < inside the tag " + std::string(text.substr(0, end));
    }
    if (end == text.size()) return "an open tag at the end";
    const std::string_view tag = text.substr(1, end - 1);
    std::size_t name_end = tag[0] == '/' ? 1 : 0;
    while (name_end < tag.size() && std::isalnum(static_cast<unsigned char>(tag[name_end]))) {
      ++name_end;
    }
    if (tag[0] == '/') {
      const std::string name(tag.substr(1, name_end - 1));
      if (open.empty() || open.back() != name) return "</" + name + "> closes nothing";
      open.pop_back();
    } else if (tag.back() != '/') {
      open.emplace_back(tag.substr(0, name_end));
    }
    text.remove_prefix(end + 1);
  }
  return open.empty() ? std::string() : "<" + open.back() + "> is not closed";
}

}  // namespace swarm::monitor
