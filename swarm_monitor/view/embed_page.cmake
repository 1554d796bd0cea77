# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# Writes the page's files as C++: cmake -DOUT=page_files.cpp -DFILES="a.html;b.js" -P embed_page.cmake
# A file's path on the server is its name; index.html is "/" as well.
function(mime_of name out)
  set(html "text/html; charset=utf-8")
  set(js "text/javascript; charset=utf-8")
  set(css "text/css; charset=utf-8")
  set(svg "image/svg+xml")
  set(png "image/png")
  set(json "application/json")
  string(REGEX REPLACE ".*\\." "" extension "${name}")
  if(NOT DEFINED ${extension})
    message(FATAL_ERROR "embed_page: what is ${name}?")
  endif()
  set(${out} "${${extension}}" PARENT_SCOPE)
endfunction()

set(arrays "")
set(rows "")
set(count 0)
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME)
  mime_of("${name}" mime)
  file(READ "${file}" hex HEX)
  if(hex STREQUAL "")
    message(FATAL_ERROR "embed_page: ${file} is empty")
  endif()
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND arrays "constexpr unsigned char kFile${count}[] = {${bytes}};\n")
  string(APPEND rows "    {\"/${name}\", \"${mime}\", kFile${count}},\n")
  if(name STREQUAL "index.html")
    string(APPEND rows "    {\"/\", \"${mime}\", kFile${count}},\n")
  endif()
  math(EXPR count "${count} + 1")
endforeach()

file(WRITE "${OUT}" "// Written by embed_page.cmake.
#include \"swarm_monitor/view/page_files.hpp\"

namespace swarm::monitor {
namespace {

${arrays}
constexpr PageFile kFiles[] = {
${rows}};

}  // namespace

std::span<const PageFile> page_files() { return kFiles; }

}  // namespace swarm::monitor
")
