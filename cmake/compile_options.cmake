# SPDX-FileCopyrightText: The Swarmflow authors
# SPDX-License-Identifier: Apache-2.0
# swarm_options: what every target of ours compiles with. Third-party headers come in as SYSTEM.
add_library(swarm_options INTERFACE)
target_compile_options(swarm_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor
  $<$<BOOL:${SWARM_WERROR}>:-Werror>)
target_compile_definitions(swarm_options INTERFACE SWARM_VERSION="${PROJECT_VERSION}")
target_include_directories(swarm_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)

if(SWARM_SANITIZE)
  add_compile_options(-fsanitize=${SWARM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SWARM_SANITIZE})
endif()
