#ifndef LMP_PAIR_SKIN_CORE_H
#define LMP_PAIR_SKIN_CORE_H

#include "pair_skin_base.h"

namespace LAMMPS_NS {

class PairSkinCore : public PairSkinBase {
 public:
  explicit PairSkinCore(class LAMMPS *);
  void compute(int, int) override;

 protected:
  double pull(const std::vector<SkinAtomPair> &, const double *) override;
  double add_energies(const std::vector<SkinAtomPair> &, const double *) const override;
  double slope(double, const double *) const override;
  double energy(double, const double *) const override;
  double range(const double *) const override;
  double closest(const double *) const override;
};

}    // namespace LAMMPS_NS

#endif
