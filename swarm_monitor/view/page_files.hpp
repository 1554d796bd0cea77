// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace swarm::monitor {

/// A file of the page, part of the program (embed_page.cmake).
struct PageFile {
  std::string_view path;  ///< "/view.js"
  std::string_view mime;
  std::span<const unsigned char> bytes;
};

std::span<const PageFile> page_files();

}  // namespace swarm::monitor
