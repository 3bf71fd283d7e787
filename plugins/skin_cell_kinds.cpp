#include "skin_cell_kinds.h"

#include "skin_arguments.h"

#include "atom.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

SkinCellKinds::SkinCellKinds(LAMMPS *lmp) : Pointers(lmp), rows(1) {}

/* ---------------------------------------------------------------------- */

void SkinCellKinds::add(SkinArguments &arguments)
{
  arguments.need(1);
  SkinCellKind row;
  row.name = arguments.word();
  if (row.name.empty() || row.name == "all" || row.name.find(',') != std::string::npos)
    error->all(FLERR, "Fix skin/cells kind {}: its name must not be empty or all, and have no "
               "comma", row.name);
  read(arguments, row, true);
  if (!row.type) error->all(FLERR, "Fix skin/cells kind {} needs the keyword type", row.name);
  add(row);
}

/* ---------------------------------------------------------------------- */

void SkinCellKinds::add(const SkinCellKind &row)
{
  if (find(row.name))
    error->all(FLERR, "Fix skin/cells kind {}: there are two kinds of this name", row.name);
  rows.push_back(row);
}

/* ---------------------------------------------------------------------- */

void SkinCellKinds::number_from(int first)
{
  for (int kind = 1; kind <= size(); kind++)
    if (!rows[kind].number) rows[kind].number = first + kind - 1;
}

/* ----------------------------------------------------------------------
   the former table stays if the new values are wrong
------------------------------------------------------------------------- */

int SkinCellKinds::change(SkinArguments &arguments)
{
  const std::string name = arguments.word();
  const int kind = find(name);
  if (!kind) error->all(FLERR, "Fix skin/cells kind {}: there is no such kind", name);
  SkinCellKinds changed(*this);
  const int before = arguments.used();
  changed.read(arguments, changed.rows[kind], false);
  if (arguments.used() == before)
    error->all(FLERR, "Fix skin/cells kind {} needs a value that can change, but got {}", name,
               arguments.at_end() ? "nothing" : arguments.following());
  changed.complete();
  rows = changed.rows;
  return kind;
}

/* ----------------------------------------------------------------------
   keywords and values of a row, up to the first word that is none of them
------------------------------------------------------------------------- */

void SkinCellKinds::read(SkinArguments &arguments, SkinCellKind &row, bool first)
{
  const std::string before = arguments.about();
  arguments.speak_of(before + " kind " + row.name);

  while (!arguments.at_end()) {
    const std::string word = arguments.following();
    if (first && word == "type") {
      arguments.keyword();
      row.type = arguments.atom_type();
    } else if (first && word == "number") {
      arguments.keyword();
      row.number = (int) arguments.integer(1);
    } else if (word == "law") {
      arguments.keyword();
      read_law(arguments, row);
    } else if (word == "detach") {
      arguments.keyword();
      const bool never = arguments.following() == "never";
      row.detachment = never ? INFINITY : arguments.number_above(1.0, "lambda");
      if (never) arguments.word();
    } else if (word == "cycle") {
      arguments.keyword();
      arguments.need(3);
      row.cycle_delay = arguments.number(SkinArguments::NOT_NEGATIVE, "T0");
      row.cycle_rate = arguments.number(SkinArguments::POSITIVE, "gamma");
      row.first_phase = arguments.number(SkinArguments::NOT_NEGATIVE, "first phase");
    } else if (word == "generations") {
      arguments.keyword();
      const bool endless = arguments.following() == "endless";
      row.generations = endless ? SkinCellKind::ENDLESS : (int) arguments.integer(0);
      if (endless) arguments.word();
    } else if (word == "daughter") {
      arguments.keyword();
      row.daughter_name = arguments.word();
    } else if (word == "last") {
      arguments.keyword();
      row.last_name = arguments.word();
    } else if (word == "paired") {
      arguments.keyword();
      arguments.need(2);
      row.paired_name = arguments.word();
      row.paired_stiffness = arguments.number(SkinArguments::NOT_NEGATIVE, "K");
    } else {
      break;
    }
  }
  arguments.speak_of(before);
}

/* ---------------------------------------------------------------------- */

void SkinCellKinds::read_law(SkinArguments &arguments, SkinCellKind &row) const
{
  const std::string law = arguments.word();
  row.stiffness = 0.0;
  row.range = INFINITY;
  if (law == "none") {
    row.law = SkinCellKind::NO_LAW;
  } else if (law == "bound") {
    row.law = SkinCellKind::BOUND;
    arguments.need(1);
    row.stiffness = arguments.number(SkinArguments::NOT_NEGATIVE, "bound K");
  } else if (law == "adhesive") {
    row.law = SkinCellKind::ADHESIVE;
    arguments.need(2);
    row.stiffness = arguments.number(SkinArguments::NOT_NEGATIVE, "adhesive K");
    row.range = arguments.number_above(1.0, "adhesive lambda");
  } else {
    error->all(FLERR, "{} law = {}: must be bound, adhesive or none", arguments.about(), law);
  }
}

/* ---------------------------------------------------------------------- */

int SkinCellKinds::find(const std::string &name) const
{
  for (int kind = 1; kind <= size(); kind++)
    if (rows[kind].name == name) return kind;
  return 0;
}

/* ---------------------------------------------------------------------- */

int SkinCellKinds::link(const SkinCellKind &row, const std::string &keyword,
                        const std::string &name) const
{
  const int kind = name.empty() ? 0 : find(name);
  if (!name.empty() && !kind)
    error->all(FLERR, "Fix skin/cells kind {} {} = {}: there is no such kind", row.name, keyword,
               name);
  return kind;
}

/* ---------------------------------------------------------------------- */

void SkinCellKinds::complete()
{
  kind_of_type.assign(atom->ntypes + 1, 0);
  for (int kind = 1; kind <= size(); kind++) {
    SkinCellKind &row = rows[kind];
    int &owner = kind_of_type[row.type];
    if (owner)
      error->all(FLERR, "Fix skin/cells kind {}: atom type {} is that of kind {}", row.name,
                 row.type, rows[owner].name);
    owner = kind;
    row.daughter = link(row, "daughter", row.daughter_name);
    row.last = link(row, "last", row.last_name);
    row.paired = link(row, "paired", row.paired_name);
  }
  for (int kind = 1; kind <= size(); kind++) check(rows[kind]);
  for (SkinCellKind &row : rows) row.spent = false;
  for (const SkinCellKind &row : rows)
    if (row.last) rows[row.last].spent = !rows[row.last].divides();
  for (int kind = 1; kind <= size(); kind++)
    if (never_enters(kind))
      error->all(FLERR, "Fix skin/cells kind {}: a cell that enters it has 0 generations in it and "
                 "in all kinds that follow as last", rows[kind].name);
}

/* ----------------------------------------------------------------------
   values that contradict each other
------------------------------------------------------------------------- */

void SkinCellKinds::check(const SkinCellKind &row) const
{
  const auto same = [&](const SkinCellKind &other) { return other.number == row.number; };
  const SkinCellKind &first = *std::find_if(rows.begin(), rows.end(), same);
  if (first.name != row.name)
    error->all(FLERR, "Fix skin/cells kind {} number = {}: is that of kind {}", row.name,
               row.number, first.name);
  if (row.paired && row.law == SkinCellKind::NO_LAW)
    error->all(FLERR, "Fix skin/cells kind {}: paired needs law bound or adhesive", row.name);
  if (row.divides() && row.cycle_rate == 0.0)
    error->all(FLERR, "Fix skin/cells kind {}: daughter needs cycle", row.name);
  if (row.limited() && !row.last)
    error->all(FLERR, "Fix skin/cells kind {} generations = {}: needs last, the kind after the "
               "last division", row.name, row.generations);
  if (row.divides()) return;
  if (row.cycle_rate > 0.0)
    error->all(FLERR, "Fix skin/cells kind {}: cycle needs daughter", row.name);
  if (row.generations != SkinCellKind::ENDLESS)
    error->all(FLERR, "Fix skin/cells kind {}: generations needs daughter", row.name);
  if (row.last) error->all(FLERR, "Fix skin/cells kind {}: last needs daughter", row.name);
}

/* ---------------------------------------------------------------------- */

int SkinCellKinds::of_number(int number) const
{
  for (int kind = 1; kind <= size(); kind++)
    if (rows[kind].number == number) return kind;
  return 0;
}

/* ---------------------------------------------------------------------- */

std::vector<int> SkinCellKinds::of_other_numbers() const
{
  std::vector<int> others;
  for (int kind = 1; kind <= size(); kind++) {
    const int place = rows[kind].number - FIRST_NUMBER;
    if (place < 0 || place >= NFIRST) others.push_back(kind);
  }
  return others;
}

/* ---------------------------------------------------------------------- */

double SkinCellKinds::longest_range() const
{
  double longest = 1.0;
  for (const SkinCellKind &row : rows)
    for (const double range : {row.range, row.detachment})
      if (std::isfinite(range)) longest = std::max(longest, range);
  return longest;
}

/* ---------------------------------------------------------------------- */

SkinCellKinds::Stage SkinCellKinds::enter(int kind) const
{
  while (rows[kind].limited() && rows[kind].generations == 0) kind = rows[kind].last;
  return {kind, rows[kind].limited() ? rows[kind].generations : 0};
}

/* ----------------------------------------------------------------------
   whether kinds with 0 generations lead to each other
------------------------------------------------------------------------- */

bool SkinCellKinds::never_enters(int kind) const
{
  for (int n = 0; n < size(); n++) {
    if (!rows[kind].limited() || rows[kind].generations > 0) return false;
    kind = rows[kind].last;
  }
  return true;
}

/* ---------------------------------------------------------------------- */

SkinCellKinds::Stage SkinCellKinds::after_division(const Stage &mother) const
{
  if (!rows[mother.kind].limited()) return mother;
  if (mother.divisions_left > 1) return {mother.kind, mother.divisions_left - 1};
  return enter(rows[mother.kind].last);
}

/* ---------------------------------------------------------------------- */

SkinCellKinds::Stage SkinCellKinds::newborn(const Stage &mother) const
{
  const SkinCellKind &row = rows[mother.kind];
  if (row.limited() && row.daughter == mother.kind) return after_division(mother);
  return enter(row.daughter);
}
