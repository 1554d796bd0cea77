# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# swarm_options: what every target of ours compiles with. Third-party headers come in as SYSTEM.
add_library(swarm_options INTERFACE)
set(swarm_warnings -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor)
if(SWARM_WERROR)
  list(APPEND swarm_warnings -Werror)
endif()
# -pthread for all, since some libraries ask for it and precompiled headers need the same flags everywhere.
target_compile_options(swarm_options INTERFACE "$<BUILD_INTERFACE:${swarm_warnings};-pthread>")
target_compile_definitions(swarm_options INTERFACE
  $<BUILD_INTERFACE:SWARM_VERSION="${PROJECT_VERSION}">)
target_compile_features(swarm_options INTERFACE cxx_std_20)
target_include_directories(swarm_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>)

if(SWARM_SANITIZE)
  add_compile_options(-fsanitize=${SWARM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SWARM_SANITIZE})
endif()
if(SWARM_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# SWARM_FAST_BUILD makes the compiler read less: headers of others that most sources include are precompiled, and
# swarm_unity() below compiles a library eight sources at a time. A header that compiles only by chance is found by
# Includes.OfTheStandardLibraryAreDirect and by a build without this option.
option(SWARM_FAST_BUILD "Precompile headers, compile most libraries eight source files at a time" OFF)
function(swarm_unity)
  if(NOT SWARM_FAST_BUILD)
    return()
  endif()
  foreach(target IN LISTS ARGN)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endforeach()
endfunction()

# One precompiled header for targets with the same flags: `owner` builds it, the others read it. ALSO: more headers in it.
# Not CLI11: its global objects would cost each source file two seconds or more.
function(swarm_precompile owner)
  if(NOT SWARM_FAST_BUILD)
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "ALSO")
  target_precompile_headers(${owner} PRIVATE
    <Eigen/Core> <Eigen/Eigenvalues> <Eigen/LU> <fmt/format.h> <tl/expected.hpp>
    <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <optional> <span> <string>
    <string_view> <utility> <variant> <vector> ${ARG_ALSO})
  foreach(target IN LISTS ARG_UNPARSED_ARGUMENTS)
    target_link_libraries(${target} PRIVATE fmt::fmt)  # its flags are part of the precompiled header
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endforeach()
endfunction()

# What runs at the start, at a user's request, or a few times a second: -O1 takes a quarter less time to compile.
function(swarm_cold)
  if(SWARM_SANITIZE)
    return()
  endif()
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>)
  endforeach()
endfunction()

# The control loop's libraries are compiled with -O3: its rate is what a run of hundreds of robots costs. In units of
# eight sources g++ would inline less, which costs 3 % of a control step, but for these limits.
function(swarm_hot)
  if(SWARM_SANITIZE)
    return()
  endif()
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O3>
      $<$<CXX_COMPILER_ID:GNU>:--param=large-unit-insns=1000000;--param=inline-unit-growth=400>)
  endforeach()
endfunction()
