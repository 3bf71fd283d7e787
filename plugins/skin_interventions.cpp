#include "skin_interventions.h"

#include "skin_arguments.h"
#include "skin_cell_kinds.h"
#include "skin_random.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>

using namespace LAMMPS_NS;

// causes in the event log that are not names of interventions

static constexpr std::string_view OTHER_CAUSES[] = {"division", "grown", "partner_removed",
                                                    "detached"};

static constexpr std::pair<std::string_view, SkinIntervention::Action> ACTIONS[] = {
    {"remove", SkinIntervention::REMOVE},
    {"convert", SkinIntervention::CONVERT},
    {"add", SkinIntervention::ADD},
    {"change", SkinIntervention::CHANGE}};

static constexpr std::string_view ALL = "all";    // kinds

// times that differ by less than this part of a timestep, or of a period, differ by rounding

static constexpr double ROUNDING = 1.0e-6;

/* ---------------------------------------------------------------------- */

bool SkinIntervention::has(int64_t occurrence) const
{
  return occurrence == 0 || (period > 0.0 && time(occurrence) <= until + ROUNDING * period);
}

/* ---------------------------------------------------------------------- */

uint64_t SkinInterventions::Due::key() const
{
  return SkinRandom::key_of(what->name) + (uint64_t) occurrence;
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::add(SkinArguments &arguments)
{
  SkinIntervention one;
  one.name = arguments.word();
  const std::string before = arguments.about();
  arguments.speak_of(before + " intervene " + one.name);

  if (!std::all_of(one.name.begin(), one.name.end(),
                   [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; }))
    error->all(FLERR, "{}: a name has letters, digits, _ and - only", arguments.about());
  if (std::count(std::begin(OTHER_CAUSES), std::end(OTHER_CAUSES), one.name))
    error->all(FLERR, "{}: this name is that of another cause in the event log",
               arguments.about());
  for (const SkinIntervention &other : list)
    if (other.name == one.name)
      error->all(FLERR, "{}: there are two interventions of this name", arguments.about());

  read_times(arguments, one);
  read_action(arguments, one);
  arguments.speak_of(before);
  list.push_back(one);
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::read_times(SkinArguments &arguments, SkinIntervention &one) const
{
  if (arguments.following() != "at")
    error->all(FLERR, "{} needs at and a time after its name", arguments.about());
  arguments.keyword();
  one.first = arguments.number(SkinArguments::NOT_NEGATIVE);

  if (arguments.following() != "every") return;
  arguments.keyword();
  one.period = arguments.number(SkinArguments::POSITIVE);

  if (arguments.following() != "until") return;
  arguments.keyword();
  one.until = arguments.number(SkinArguments::NOT_NEGATIVE);
  if (one.until < one.first)
    error->all(FLERR, "{} until = {}: must be >= {}, its first time", arguments.about(), one.until,
               one.first);
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::read_action(SkinArguments &arguments, SkinIntervention &one) const
{
  const std::string word = arguments.following();
  const auto *const action = std::find_if(std::begin(ACTIONS), std::end(ACTIONS),
                                          [&](const auto &row) { return row.first == word; });
  if (action == std::end(ACTIONS))
    error->all(FLERR, "{} needs remove, convert, add or change after its times",
               arguments.about());
  arguments.keyword();
  one.action = action->second;

  if (one.action == SkinIntervention::REMOVE) {
    one.from_name = arguments.word();
    read_choice(arguments, one);
  } else if (one.action == SkinIntervention::CONVERT) {
    arguments.need(2);
    one.from_name = arguments.word();
    one.to_name = arguments.word();
    read_choice(arguments, one);
  } else if (one.action == SkinIntervention::ADD) {
    one.to_name = arguments.word();
    read_places(arguments, one);
  }
}

/* ----------------------------------------------------------------------
   which of the cells of a kind
------------------------------------------------------------------------- */

void SkinInterventions::read_choice(SkinArguments &arguments, SkinIntervention &one) const
{
  while (true) {
    const std::string word = arguments.following();
    if (word == "fraction") {
      arguments.keyword();
      one.fraction = arguments.number(SkinArguments::POSITIVE);
      if (one.fraction > 1.0)
        error->all(FLERR, "{} fraction = {}: must be <= 1", arguments.about(), one.fraction);
    } else if (word == "cylinder") {
      arguments.keyword();
      arguments.need(3);
      SkinIntervention::Region region = {SkinIntervention::Region::CYLINDER, {}};
      for (int d = 0; d < 2; d++) region.value[d] = read_coordinate(arguments, d);
      region.value[2] = arguments.number(SkinArguments::POSITIVE, "R");
      one.regions.push_back(region);
    } else if (word == "half_space") {
      arguments.keyword();
      arguments.need(4);
      SkinIntervention::Region region = {SkinIntervention::Region::HALF_SPACE, {}};
      double *const n = region.value;
      for (int k = 0; k < 4; k++) n[k] = arguments.number(SkinArguments::FINITE);
      double highest = 0.0;    // of its products with places in the box
      for (int d = 0; d < 3; d++) highest += std::max(n[d] * low(d), n[d] * high(d));
      if (!(highest > n[3]))
        error->all(FLERR, "{} half_space = {} {} {} {}: no place in the box is in it",
                   arguments.about(), n[0], n[1], n[2], n[3]);
      one.regions.push_back(region);
    } else {
      return;
    }
  }
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::read_places(SkinArguments &arguments, SkinIntervention &one) const
{
  while (one.places.empty() || utils::is_double(arguments.following())) {
    arguments.need(3);
    SkinIntervention::Place place = {};
    for (int d = 0; d < 2; d++) place.x[d] = read_coordinate(arguments, d);
    place.on_membrane = arguments.following() == "nearest";
    if (place.on_membrane) arguments.word();
    else place.x[2] = read_coordinate(arguments, 2);
    one.places.push_back(place);
  }
}

/* ----------------------------------------------------------------------
   ends of the box
------------------------------------------------------------------------- */

double SkinInterventions::low(int d) const
{
  return domain->triclinic ? domain->boxlo_bound[d] : domain->boxlo[d];
}

double SkinInterventions::high(int d) const
{
  return domain->triclinic ? domain->boxhi_bound[d] : domain->boxhi[d];
}

/* ---------------------------------------------------------------------- */

double SkinInterventions::read_coordinate(SkinArguments &arguments, int dimension) const
{
  const std::string name(1, "xyz"[dimension]);
  const double value = arguments.number(SkinArguments::FINITE, name);
  if (value < low(dimension) || value > high(dimension))
    error->all(FLERR, "{} = {}: must be within the box, from {} to {}", arguments.named(name),
               value, low(dimension), high(dimension));
  return value;
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::complete(const SkinCellKinds &kinds)
{
  const auto find = [&](const SkinIntervention &one, const std::string &name) {
    const int kind = kinds.find(name);
    if (!kind)
      error->all(FLERR, "Fix skin/cells intervene {} kind = {}: there is no such kind", one.name,
                 name);
    return kind;
  };
  for (SkinIntervention &one : list) {
    if (!one.to_name.empty()) one.to = find(one, one.to_name);
    one.from.assign(kinds.size() + 1, one.from_name == ALL);
    std::istringstream names(one.from_name == ALL ? "" : one.from_name);
    for (std::string name; std::getline(names, name, ',');) one.from[find(one, name)] = true;
  }
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::begin(double time)
{
  for (const SkinIntervention &one : list)
    if (one.period > 0.0 && one.period < update->dt * (1.0 - ROUNDING))
      error->all(FLERR, "Fix skin/cells intervene {} every = {}: must be >= {}, the timestep",
                 one.name, one.period, update->dt);
  if (std::isfinite(past)) return;
  past = time - ROUNDING * update->dt;
  if (comm->me != 0) return;
  for (const SkinIntervention &one : list)
    if ((one.period > 0.0 ? one.until : one.first) <= past)
      error->warning(FLERR, "Fix skin/cells intervene {}: does not happen, for its time is before "
                     "{}, when the fix begins", one.name, time);
}

/* ---------------------------------------------------------------------- */

double SkinInterventions::latest(double time) const
{
  return time + ROUNDING * update->dt;
}

/* ----------------------------------------------------------------------
   in the order of their times, at one time in that in which they were given
------------------------------------------------------------------------- */

std::vector<SkinInterventions::Due> SkinInterventions::due(double time) const
{
  std::vector<Due> found;
  for (const SkinIntervention &one : list) {
    int64_t k = 0;
    if (one.period > 0.0 && past > one.first)
      k = std::max((int64_t) ((past - one.first) / one.period) - 1, k);
    for (; one.has(k) && one.time(k) <= latest(time); k++)
      if (one.time(k) > past) found.push_back({&one, k});
  }
  std::stable_sort(found.begin(), found.end(), [](const Due &a, const Due &b) {
    return a.what->time(a.occurrence) < b.what->time(b.occurrence);
  });
  return found;
}

/* ---------------------------------------------------------------------- */

void SkinInterventions::pass(double time)
{
  past = std::max(past, latest(time));
}

/* ---------------------------------------------------------------------- */

bool SkinInterventions::concerns(const Due &due, bigint seed, int kind, tagint id,
                                 const double *x) const
{
  const SkinIntervention &one = *due.what;
  if (!one.from[kind]) return false;
  for (const SkinIntervention::Region &region : one.regions)
    if (!inside(region, x)) return false;
  return SkinRandom::uniform(seed, id, due.key(), SkinRandom::CHOICE) < one.fraction;
}

/* ---------------------------------------------------------------------- */

bool SkinInterventions::inside(const SkinIntervention::Region &region, const double *x) const
{
  const double *const value = region.value;
  if (region.shape == SkinIntervention::Region::HALF_SPACE)
    return value[0] * x[0] + value[1] * x[1] + value[2] * x[2] > value[3];
  double delta[3] = {x[0] - value[0], x[1] - value[1], 0.0};
  domain->minimum_image(FLERR, delta);
  return delta[0] * delta[0] + delta[1] * delta[1] < value[2] * value[2];
}
