#include "skin_arguments.h"

#include "atom.h"
#include "error.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

const std::string &SkinArguments::keyword()
{
  return key = arg[next++];
}

/* ---------------------------------------------------------------------- */

void SkinArguments::need(int n) const
{
  if (narg - next < n)
    error->all(FLERR, "{} {} needs {} value(s) but got {}", subject, key, n, narg - next);
}

/* ---------------------------------------------------------------------- */

std::string SkinArguments::word()
{
  need(1);
  return arg[next++];
}

/* ---------------------------------------------------------------------- */

double SkinArguments::number(Allowed allowed, const std::string &part)
{
  const std::string text = word();
  const double value = utils::numeric(FLERR, text, false, lmp);
  const bool right = allowed == POSITIVE ? value > 0.0 : allowed == FINITE || value >= 0.0;
  if (!std::isfinite(value) || !right)
    error->all(FLERR, "{} = {}: must be a number {}", named(part), text,
               allowed == POSITIVE ? "> 0" : allowed == FINITE ? "that is finite" : ">= 0");
  return value;
}

/* ---------------------------------------------------------------------- */

double SkinArguments::number_above(double bound, const std::string &part)
{
  const std::string text = following();
  const double value = number(POSITIVE, part);
  if (!(value > bound)) error->all(FLERR, "{} = {}: must be > {}", named(part), text, bound);
  return value;
}

/* ---------------------------------------------------------------------- */

std::string SkinArguments::named(const std::string &part) const
{
  return subject + " " + key + (part.empty() ? "" : " " + part);
}

/* ---------------------------------------------------------------------- */

bigint SkinArguments::integer(bigint least, bigint most)
{
  const std::string text = word();
  const bigint value = utils::bnumeric(FLERR, text, false, lmp);
  if (value < least || value > most)
    error->all(FLERR, "{} {} = {}: must be an integer {}", subject, key, text,
               value < least ? fmt::format(">= {}", least) : fmt::format("<= {}", most));
  return value;
}

/* ---------------------------------------------------------------------- */

int SkinArguments::atom_type()
{
  const std::string text = word();
  const int type = utils::expand_type_int(FLERR, text, Atom::ATOM, lmp);
  if (type < 1 || type > atom->ntypes)
    error->all(FLERR, "{} {} = {}: there are atom types 1 to {}", subject, key, text,
               atom->ntypes);
  return type;
}
