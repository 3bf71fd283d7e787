// The four kinds of cells of the model in few words: `stem T`, `ta T`, `exhausted T` and `nd T`
// with values that they share, instead of a row with the keyword `kind` for each.

#ifndef LMP_SKIN_MODEL_KINDS_H
#define LMP_SKIN_MODEL_KINDS_H

#include "skin_cell_kinds.h"

#include <map>
#include <string>

namespace LAMMPS_NS {

class SkinModelKinds {
 public:
  // take the values of a keyword, false if it is not one of these

  bool read(const std::string &keyword, SkinArguments &);

  bool any() const { return !types.empty(); }
  void add_to(SkinCellKinds &, class Error *) const;

 private:
  std::map<std::string, int> types;    // atom types of the kinds that are given
  std::map<std::string, bool> given;
  double adhesion = 0.0, range = 0.0, binding = 0.0;
  double delay = 0.0, rate = 0.0, phase = 0.0;
  int generations = 0;
};

}    // namespace LAMMPS_NS

#endif
