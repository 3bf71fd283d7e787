// What the pair styles of the skin share: coefficients, lists of pairs, energies. They list their
// pairs themselves, since each concerns few pairs of types and the lists of LAMMPS are made for
// all of them together.

#include "pair_skin_base.h"

#include "skin_remedy.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr int STIFFNESS = 0, CONTACT = 1;

/* ---------------------------------------------------------------------- */

PairSkinBase::PairSkinBase(LAMMPS *lmp, const char *style, double core,
                   const std::vector<Coefficient> &names) :
    Pair(lmp), style(style), core(core), names(names), ncoeffs((int) names.size()), coeffs(nullptr),
    contacts(lmp), kinds_known(false)
{
  writedata = 1;
  respa_enable = 0;
}

/* ---------------------------------------------------------------------- */

PairSkinBase::~PairSkinBase()
{
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
    memory->destroy(coeffs);
  }
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  const bool built = build.is_new(neighbor);
  if (built) contacts.clear();    // of the former build, whose indices are no more
  if (!kinds_known) find_kinds();
  if (built) contacts.build();

  least.assign(of_kind.size(), INFINITY);
  for (size_t kind = 0; kind < of_kind.size(); kind++) {
    const std::vector<SkinAtomPair> &pairs = contacts.of_kind[kind];
    const double *const c = of_kind[kind].data();
    if (c[STIFFNESS] != 0.0 && !pairs.empty()) least[kind] = pull(pairs, c);
  }
  if (update->setupflag) first_least = least;
  if (evflag) tally();
  if (vflag_fdotr) virial_fdotr_compute();
}

/* ----------------------------------------------------------------------
   pairs of types with the same coefficients are of one kind. Those that are another sub-style's in
   a hybrid style have no cutoff here, whatever coefficients they once had
------------------------------------------------------------------------- */

void PairSkinBase::find_kinds()
{
  const int n = atom->ntypes;
  std::vector<int> kinds((n + 1) * (n + 1), -1);
  std::vector<double> distances;
  of_kind.clear();

  for (int i = 1; i <= n; i++)
    for (int j = i; j <= n; j++) {
      if (cutsq[i][j] == 0.0) continue;
      const std::vector<double> c = of_types(i, j);
      const double cutoff = std::sqrt(cutsq[i][j]);
      if (range(c.data()) > cutoff * (1.0 + 1.0e-12))
        error->all(FLERR,
                   "Pair style {}: types {} and {} have the range {} on step {}, but neighbor "
                   "lists were made for {}; begin the run with the longest range", style, i, j,
                   range(c.data()), update->ntimestep, cutoff);
      size_t kind = 0;
      while (kind < of_kind.size() && (of_kind[kind] != c || distances[kind] != cutoff)) kind++;
      kinds[i * (n + 1) + j] = kinds[j * (n + 1) + i] = (int) kind;
      if (kind < of_kind.size()) continue;
      of_kind.push_back(c);
      distances.push_back(cutoff);
    }
  contacts.set_kinds(kinds, distances);
  first_least.clear();
  kinds_known = true;
}

/* ---------------------------------------------------------------------- */

std::vector<double> PairSkinBase::of_types(int i, int j) const
{
  std::vector<double> c(ncoeffs);
  for (int k = 0; k < ncoeffs; k++) c[k] = coeffs[k][i][j];
  return c;
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::tally()
{
  double **x = atom->x;
  const bool each = eflag_atom || vflag_either || num_tally_compute;
  for (size_t kind = 0; kind < of_kind.size(); kind++) {
    const double *const c = of_kind[kind].data();
    if (!each) {
      eng_vdwl += add_energies(contacts.of_kind[kind], c);
      continue;
    }
    for (const auto &[i, j] : contacts.of_kind[kind]) {
      const double dx = x[i][0] - x[j][0], dy = x[i][1] - x[j][1], dz = x[i][2] - x[j][2];
      const double rsq = dx * dx + dy * dy + dz * dz;
      if (rsq >= range(c) * range(c)) continue;
      const double e = eflag_either ? energy(rsq, c) : 0.0;
      ev_tally(i, j, atom->nlocal, 1, e, 0.0, slope(rsq, c), dx, dy, dz);
    }
  }
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::check_overlap() const
{
  for (size_t kind = 0; kind < least.size(); kind++) {
    const double within = closest(of_kind[kind].data());
    if (!(least[kind] < within * within)) continue;
    const bool at_start = kind < first_least.size() && first_least[kind] < within * within;
    for (const auto &[i, j] : contacts.of_kind[kind]) {
      const double *const x = atom->x[i], *const y = atom->x[j];
      const double r = std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                                 (x[2] - y[2]) * (x[2] - y[2]));
      if (r < within)
        error->one(FLERR,
                   "Pair {}: atoms {} and {} of types {} and {} overlap on step {}: their distance "
                   "is {}, less than {}{}",
                   style, atom->tag[i], atom->tag[j], atom->type[i], atom->type[j],
                   update->ntimestep, r, within, skin_remedy(update, modify, at_start));
    }
  }
}

/* ---------------------------------------------------------------------- */

double PairSkinBase::range(const double *c) const
{
  return c[CONTACT] * c[ncoeffs - 1];
}

/* ---------------------------------------------------------------------- */

double PairSkinBase::closest(const double *c) const
{
  return core * c[CONTACT];
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::settings(int narg, char ** /*arg*/)
{
  if (narg != 0) error->all(FLERR, "Pair style {} needs no arguments, but got {}", style, narg);
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::allocate()
{
  allocated = 1;
  const int np1 = atom->ntypes + 1;

  memory->create(setflag, np1, np1, "pair:setflag");
  memory->create(cutsq, np1, np1, "pair:cutsq");
  memory->create(coeffs, ncoeffs, np1, np1, "pair:coeffs");
  for (int i = 0; i < np1; i++)
    for (int j = 0; j < np1; j++) {
      setflag[i][j] = 0;
      cutsq[i][j] = 0.0;
      for (int k = 0; k < ncoeffs; k++) coeffs[k][i][j] = 0.0;
    }
}

/* ----------------------------------------------------------------------
   set coeffs for one or more pairs of types
------------------------------------------------------------------------- */

void PairSkinBase::coeff(int narg, char **arg)
{
  if (narg != ncoeffs + 2)
    error->all(FLERR, "Pair style {} needs {} coefficients for a pair of types, but got {}", style,
               ncoeffs, narg - 2);
  if (!allocated) allocate();

  int ilo, ihi, jlo, jhi;
  utils::bounds_typelabel(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, lmp, Atom::ATOM);
  utils::bounds_typelabel(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, lmp, Atom::ATOM);

  std::vector<double> values(ncoeffs);
  for (int k = 0; k < ncoeffs; k++) {
    values[k] = utils::numeric(FLERR, arg[k + 2], false, lmp);
    check(k, values[k], arg[k + 2]);
  }

  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++) {
      for (int k = 0; k < ncoeffs; k++) coeffs[k][i][j] = values[k];
      setflag[i][j] = 1;
    }
}

/* ----------------------------------------------------------------------
   whether a coefficient may have this value, which was given as this text
------------------------------------------------------------------------- */

void PairSkinBase::check(int k, double v, const std::string &text) const
{
  static const char *const MUST[] = {"a number >= 0", "a number > 0 and < 1", "a number >= 1"};
  const Allowed allowed = names[k].allowed;
  if (k == CONTACT && !(v > 0.0))
    error->all(FLERR, "Pair style {}: {} = {} must be a number > 0", style, names[k].name, text);
  if (!std::isfinite(v) || v < 0.0 || (allowed == ONE_OR_MORE && v < 1.0) ||
      (allowed == FRACTION && !(v > 0.0 && v < 1.0)))
    error->all(FLERR, "Pair style {}: {} = {} must be {}", style, names[k].name, text,
               MUST[allowed]);
}

/* ----------------------------------------------------------------------
   no list of LAMMPS is asked for; cutoffs are those of init_one(), which a hybrid style calls for
   the pairs of types that it leaves to this sub-style
------------------------------------------------------------------------- */

void PairSkinBase::init_style()
{
  if (!force->newton_pair) error->all(FLERR, "Pair style {} needs newton on for pairs", style);
  const double *const special = force->special_lj;
  if (atom->molecular != Atom::ATOMIC &&
      (special[1] != 0.0 || special[2] != 1.0 || special[3] != 1.0))
    error->all(FLERR, "Pair style {} needs special_bonds lj 0.0 1.0 1.0; it got {} {} {}", style,
               special[1], special[2], special[3]);
  if (atom->molecular == Atom::TEMPLATE)
    error->all(FLERR, "Pair style {} does not know the special neighbors of atom style template: "
               "use another atom style", style);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = 1; j <= atom->ntypes; j++) cutsq[i][j] = 0.0;
  kinds_known = false;
  build.forget();
  contacts.clear();
  least.clear();
}

/* ---------------------------------------------------------------------- */

double PairSkinBase::init_one(int i, int j)
{
  if (!setflag[i][j]) error->all(FLERR, "All pair coeffs are not set: types {} and {}", i, j);
  for (int k = 0; k < ncoeffs; k++) {
    check(k, coeffs[k][i][j], fmt::format("{}", coeffs[k][i][j]));
    coeffs[k][j][i] = coeffs[k][i][j];
  }
  kinds_known = false;
  return range(of_types(i, j).data());
}

/* ----------------------------------------------------------------------
   a coefficient by the first word of its name, for commands that change it, which call init_one()
   then
------------------------------------------------------------------------- */

void *PairSkinBase::extract(const char *which, int &dim)
{
  dim = 2;
  for (int k = 0; k < ncoeffs; k++) {
    const std::string name = names[k].name;
    if (name.substr(0, name.find(' ')) == which) return (void *) coeffs[k];
  }
  return nullptr;
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::write_restart(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      size_t written = fwrite(&setflag[i][j], sizeof(int), 1, fp);
      const std::vector<double> c = of_types(i, j);
      if (setflag[i][j]) written += fwrite(c.data(), sizeof(double), ncoeffs, fp);
      if (written != (size_t) (setflag[i][j] ? 1 + ncoeffs : 1))
        error->one(FLERR, "Pair style {}: cannot write to the restart file: {}", style,
                   utils::getsyserror());
    }
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::read_restart(FILE *fp)
{
  allocate();

  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      if (comm->me == 0) utils::sfread(FLERR, &setflag[i][j], sizeof(int), 1, fp, nullptr, error);
      MPI_Bcast(&setflag[i][j], 1, MPI_INT, 0, world);
      if (!setflag[i][j]) continue;
      std::vector<double> c(ncoeffs);
      if (comm->me == 0)
        utils::sfread(FLERR, c.data(), sizeof(double), ncoeffs, fp, nullptr, error);
      MPI_Bcast(c.data(), ncoeffs, MPI_DOUBLE, 0, world);
      for (int k = 0; k < ncoeffs; k++) coeffs[k][i][j] = c[k];
    }
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++) {
    utils::print(fp, "{}", i);
    for (int k = 0; k < ncoeffs; k++) utils::print(fp, " {:.17g}", coeffs[k][i][i]);
    utils::print(fp, "\n");
  }
}

/* ---------------------------------------------------------------------- */

void PairSkinBase::write_data_all(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      utils::print(fp, "{} {}", i, j);
      for (int k = 0; k < ncoeffs; k++) utils::print(fp, " {:.17g}", coeffs[k][i][j]);
      utils::print(fp, "\n");
    }
}

/* ---------------------------------------------------------------------- */

double PairSkinBase::single(int /*i*/, int /*j*/, int itype, int jtype, double rsq,
                        double /*factor_coul*/, double factor_lj, double &fforce)
{
  const std::vector<double> all = of_types(itype, jtype);
  const double *const c = all.data();
  fforce = factor_lj * slope(rsq, c);
  return rsq < range(c) * range(c) ? factor_lj * energy(rsq, c) : 0.0;
}

/* ---------------------------------------------------------------------- */

double PairSkinBase::memory_usage()
{
  return Pair::memory_usage() + contacts.memory_usage();
}
