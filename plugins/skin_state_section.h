// The section of a data file from which read_data takes the state of cells that it adds. LAMMPS
// does not mind if the file has no such section.

#ifndef LMP_SKIN_STATE_SECTION_H
#define LMP_SKIN_STATE_SECTION_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class SkinStateSection : protected Pointers {
 public:
  explicit SkinStateSection(class LAMMPS *lmp) : Pointers(lmp) {}

  // its title, as the command that is carried out names it; empty if it names none

  std::string title() const;

  // an error that names this atom if the file has no such section; it is looked at once, unless it
  // has changed

  void check(tagint id);

 private:
  std::string looked_at;    // data file and section that have been found to be there
};

}    // namespace LAMMPS_NS

#endif
