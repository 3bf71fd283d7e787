// What the plugin was compiled for, against the LAMMPS that it is loaded into: their binary
// interfaces differ even between the updates of one release.

#ifndef LMP_SKIN_BINARY_H
#define LMP_SKIN_BINARY_H

namespace LAMMPS_NS {
class LAMMPS;
}

// why the plugin was not loaded, or an empty text

extern "C" __attribute__((visibility("default"))) const char *skin_refusal();

// whether the plugin fits to a LAMMPS; where it does not, one line says why

bool skin_fits(LAMMPS_NS::LAMMPS *, void *handle);

#endif
