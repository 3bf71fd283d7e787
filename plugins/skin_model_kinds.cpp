#include "skin_model_kinds.h"

#include "skin_arguments.h"

#include "error.h"

using namespace LAMMPS_NS;

namespace {

// what a kind does, its newborn and what it becomes; those that are not bound may leave

struct ModelKind {
  const char *name;
  SkinCellKind::Law law;
  const char *daughter, *last;
};

const ModelKind MODEL[] = {
    {"stem", SkinCellKind::BOUND, "ta", ""},
    {"ta", SkinCellKind::ADHESIVE, "ta", "exhausted"},
    {"exhausted", SkinCellKind::NO_LAW, "", ""},
    {"nd", SkinCellKind::BOUND, "", ""},
};

const char *const SHARED[] = {"adhesion", "binding", "cycle", "generations"};

}    // namespace

/* ---------------------------------------------------------------------- */

bool SkinModelKinds::read(const std::string &keyword, SkinArguments &arguments)
{
  for (const ModelKind &kind : MODEL)
    if (keyword == kind.name) {
      types[keyword] = arguments.atom_type();
      return true;
    }

  if (keyword == "adhesion") {
    arguments.need(2);
    adhesion = arguments.number(SkinArguments::NOT_NEGATIVE, "K");
    range = arguments.number_above(1.0, "lambda");
  } else if (keyword == "binding") {
    binding = arguments.number(SkinArguments::NOT_NEGATIVE);
  } else if (keyword == "cycle") {
    arguments.need(3);
    delay = arguments.number(SkinArguments::NOT_NEGATIVE, "T0");
    rate = arguments.number(SkinArguments::POSITIVE, "gamma");
    phase = arguments.number(SkinArguments::NOT_NEGATIVE, "first phase");
  } else if (keyword == "generations") {
    generations = (int) arguments.integer(0);
  } else {
    return false;
  }
  given[keyword] = true;
  return true;
}

/* ---------------------------------------------------------------------- */

void SkinModelKinds::add_to(SkinCellKinds &kinds, Error *error) const
{
  for (const char *keyword : SHARED)
    if (any() && !given.count(keyword))
      error->all(FLERR, "Fix skin/cells needs the keyword {} with the keyword {}", keyword,
                 types.begin()->first);
    else if (!any() && given.count(keyword))
      error->all(FLERR, "Fix skin/cells {}: is for the kinds stem, ta, exhausted and nd, which are "
                 "not given", keyword);

  int number = SkinCellKinds::FIRST_NUMBER;
  kinds.number_from(any() ? number + SkinCellKinds::NFIRST : number);
  for (const ModelKind &model : MODEL) {
    SkinCellKind row;
    row.name = model.name;
    row.number = number++;
    if (!types.count(row.name)) continue;
    row.type = types.at(row.name);
    row.law = model.law;
    if (row.law != SkinCellKind::NO_LAW)
      row.stiffness = row.law == SkinCellKind::BOUND ? binding : adhesion;
    if (row.law == SkinCellKind::ADHESIVE) row.range = range;
    if (row.law != SkinCellKind::BOUND) row.detachment = range;
    row.daughter_name = model.daughter;
    row.last_name = model.last;
    if (!row.last_name.empty()) row.generations = generations;
    if (!row.daughter_name.empty()) {
      row.cycle_delay = delay;
      row.cycle_rate = rate;
      row.first_phase = phase;
    }
    kinds.add(row);
  }
}
