// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Writes the seeds of all decoders: fuzz_seeds FOLDER makes FOLDER/DECODER/0, 1, … and prints the
// names of the decoders.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fuzz/decoders.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 3;
  }
  for (const swarm::fuzz::Decoder& decoder : swarm::fuzz::decoders()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / decoder.name;
    std::filesystem::create_directories(folder);
    std::size_t number = 0;
    for (const swarm::fuzz::Bytes& seed : decoder.seeds()) {
      std::ofstream out(folder / std::to_string(number++), std::ios::binary);
      out.write(reinterpret_cast<const char*>(seed.data()),
                static_cast<std::streamsize>(seed.size()));
      if (!out) return 2;
    }
    std::puts(std::string(decoder.name).c_str());
  }
}
