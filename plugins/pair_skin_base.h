#ifndef LMP_PAIR_SKIN_BASE_H
#define LMP_PAIR_SKIN_BASE_H

#include "pair.h"

#include "skin_build.h"
#include "skin_contacts.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// what the pair styles of the skin have in common; each has coefficients, of which the first is a
// stiffness, 0 for no pairs at all, the second a contact length and the last mostly a range in
// contact lengths

class PairSkinBase : public Pair {
 public:
  enum Allowed { NOT_NEGATIVE, FRACTION, ONE_OR_MORE };
  struct Coefficient {
    const char *name;
    Allowed allowed;
  };

  PairSkinBase(class LAMMPS *, const char *style, double core, const std::vector<Coefficient> &);
  ~PairSkinBase() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  void write_data_all(FILE *) override;
  double single(int, int, int, int, double, double, double, double &) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

  // ends the run if two particles of the last compute() have come closer than their core, a part
  // of the contact length

  void check_overlap() const;

 protected:
  // forces of all pairs of a kind, of which there are some, with its coefficients; returns the
  // least of their squared distances

  virtual double pull(const std::vector<SkinAtomPair> &, const double *coeffs) = 0;

  // energy of all pairs of a kind

  virtual double add_energies(const std::vector<SkinAtomPair> &, const double *coeffs) const = 0;

  // -dE/dr / r and E of one pair

  virtual double slope(double rsq, const double *coeffs) const = 0;
  virtual double energy(double rsq, const double *coeffs) const = 0;

  // distance up to which there are forces, and below which a run ends

  virtual double range(const double *coeffs) const;
  virtual double closest(const double *coeffs) const;

 private:
  std::string style;
  double core;
  std::vector<Coefficient> names;
  int ncoeffs;
  double ***coeffs;    // each of them for all pairs of types
  SkinContacts contacts;
  SkinBuild build;                             // that the contacts belong to
  std::vector<std::vector<double>> of_kind;    // coefficients of each kind of contact
  std::vector<double> least, first_least;      // squared distance of each kind, now and at setup
  bool kinds_known;

  void allocate();
  void check(int, double, const std::string &) const;
  std::vector<double> of_types(int, int) const;
  void find_kinds();
  void tally();
};

}    // namespace LAMMPS_NS

#endif
