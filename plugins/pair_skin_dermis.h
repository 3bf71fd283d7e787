#ifndef LMP_PAIR_SKIN_DERMIS_H
#define LMP_PAIR_SKIN_DERMIS_H

#include "pair_skin_base.h"

namespace LAMMPS_NS {

class PairSkinDermis : public PairSkinBase {
 public:
  explicit PairSkinDermis(class LAMMPS *);

 protected:
  double pull(const std::vector<SkinAtomPair> &, const double *) override;
  double add_energies(const std::vector<SkinAtomPair> &, const double *) const override;
  double slope(double, const double *) const override;
  double energy(double, const double *) const override;
};

}    // namespace LAMMPS_NS

#endif
