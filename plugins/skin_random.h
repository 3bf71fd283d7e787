// Random numbers that depend on what they decide, never on the order in which they are drawn:
// the key is (seed, cell, event, purpose).

#ifndef LMP_SKIN_RANDOM_H
#define LMP_SKIN_RANDOM_H

#include <cstdint>
#include <string>

namespace LAMMPS_NS {
namespace SkinRandom {

  enum Purpose : uint64_t {
    WAIT = 1,
    ORIENTATION = 2,
    FIRST_PHASE = 3,
    CHOICE = 4,
    CONVERTED_WAIT = 5
  };

  // a bijection of 64-bit integers with full avalanche (the finaliser of splitmix64)

  inline uint64_t mix(uint64_t z)
  {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  // FNV-1a, for events that have names

  inline uint64_t key_of(const std::string &name)
  {
    uint64_t h = 0xcbf29ce484222325ULL;
    for (const unsigned char c : name) h = (h ^ c) * 0x100000001b3ULL;
    return h;
  }

  // uniform in the open interval (0,1): the last of the 2^53 values would round to 1

  inline double uniform(uint64_t seed, uint64_t cell, uint64_t event, Purpose purpose)
  {
    const uint64_t h = mix(mix(mix(mix(seed) ^ cell) ^ event) ^ purpose);
    const double u = ((double) (h >> 11) + 0.5) * 0x1.0p-53;
    return u < 1.0 ? u : 1.0 - 0x1.0p-53;
  }

}    // namespace SkinRandom
}    // namespace LAMMPS_NS

#endif
