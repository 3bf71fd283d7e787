#ifndef LMP_PAIR_SKIN_LJ_H
#define LMP_PAIR_SKIN_LJ_H

#include "pair_skin.h"

namespace LAMMPS_NS {

class PairSkinLJ : public PairSkin {
 public:
  explicit PairSkinLJ(class LAMMPS *);

 protected:
  double pull(const std::vector<SkinTwo> &, const double *) override;
  double slope(double, const double *) const override;
  double energy(double, const double *) const override;
};

}    // namespace LAMMPS_NS

#endif
