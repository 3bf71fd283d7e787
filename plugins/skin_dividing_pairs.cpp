#include "skin_dividing_pairs.h"

#include "skin_arguments.h"
#include "skin_gather.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void SkinDividingPairs::read_spring(SkinArguments &arguments)
{
  arguments.need(4);
  stiffness = arguments.number(SkinArguments::NOT_NEGATIVE, "K");
  start = arguments.number(SkinArguments::NOT_NEGATIVE, "start");
  rate = arguments.number(SkinArguments::POSITIVE, "rate");
  end = arguments.number(SkinArguments::POSITIVE, "end");
  if (end <= start)
    error->all(FLERR, "Fix skin/cells spring: its end {} must be longer than its start {}", end,
               start);
}

/* ---------------------------------------------------------------------- */

double SkinDividingPairs::end_time(int i) const
{
  return cells.state.pair_start[i] + (end - start) / rate;
}

/* ---------------------------------------------------------------------- */

int SkinDividingPairs::partner_of(int i) const
{
  const tagint other = cells.state.pair[i];
  const int j = cells.local_index(other);
  if (j < 0)
    error->one(FLERR, "Fix skin/cells: the cells {} and {} of a dividing pair have lost each other "
               "on step {}{}", atom->tag[i], other, update->ntimestep, cells.remedy());
  return domain->closest_image(i, j);
}

/* ---------------------------------------------------------------------- */

SkinDividingPairs::Spring SkinDividingPairs::spring(int i) const
{
  const double *xi = atom->x[i], *xj = atom->x[partner_of(i)];
  Spring s = {{xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]}, 0.0, 0.0, 0.0};
  s.distance = std::sqrt(s.way[0] * s.way[0] + s.way[1] * s.way[1] + s.way[2] * s.way[2]);
  if (s.distance == 0.0)
    error->one(FLERR, "Fix skin/cells: the cells {} and {} of a dividing pair are at one point",
               atom->tag[i], cells.state.pair[i]);

  if (std::fabs(s.way[2]) > domain->prd[2]) return s;    // one of them has left

  const double age = cells.clock.now() - cells.state.pair_start[i];
  const double length = std::min(start + rate * age, end);
  const double stretch = s.distance - length;
  s.factor = -stiffness * stretch / s.distance;
  s.energy = 0.5 * stiffness * stretch * stretch;
  return s;
}

/* ---------------------------------------------------------------------- */

void SkinDividingPairs::begin(int i, tagint other, double time)
{
  cells.state.pair[i] = other;
  cells.state.pair_start[i] = time;
  hide(i, other);
}

/* ----------------------------------------------------------------------
   told by the owners of the younger cells. With a distance that the two must have, the end is now.
------------------------------------------------------------------------- */

std::vector<SkinCellEvent> SkinDividingPairs::grown() const
{
  const double now = cells.clock.now();
  std::vector<SkinCellEvent> ends;
  for (int i : cells.list) {
    if (!grown_by(i, now) || cells.state.pair[i] > atom->tag[i]) continue;
    if (apart > 0.0 && !(spring(i).distance > apart)) continue;
    ends.push_back(cells.event(i, SkinCellEvent::GROWN, apart > 0.0 ? now : end_time(i)));
  }
  return ends;
}

/* ----------------------------------------------------------------------
   my ends of pairs that follow from deaths on any rank
------------------------------------------------------------------------- */

std::vector<SkinCellEvent>
SkinDividingPairs::ended_by(const std::vector<SkinCellEvent> &events) const
{
  std::vector<SkinCellEvent> ends;
  for (const SkinCellEvent &event : events) {
    if (event.kind != SkinCellEvent::DEATH || !event.other) continue;
    const int i = cells.owned_index(std::max(event.id, event.other));
    if (i >= 0) ends.push_back(cells.event(i, SkinCellEvent::PARTNER_REMOVED, event.time));
  }
  return ends;
}

/* ---------------------------------------------------------------------- */

std::vector<SkinCellEvent> SkinDividingPairs::widowed() const
{
  std::vector<tagint> missing;
  for (int i = 0; i < atom->nlocal; i++)
    if (cells.kind_of(i) != SkinCells::NONE && cells.state.pair[i] &&
        cells.local_index(cells.state.pair[i]) < 0)
      missing.push_back(cells.state.pair[i]);
  const std::vector<tagint> gone = missing_ids(skin_gather(missing, world));
  if (gone.empty()) return {};

  std::vector<SkinCellEvent> ends;
  for (int i = 0; i < atom->nlocal; i++) {
    const tagint other = cells.state.pair[i];
    if (cells.kind_of(i) == SkinCells::NONE ||
        std::find(gone.begin(), gone.end(), other) == gone.end())
      continue;
    ends.push_back(cells.event(i, SkinCellEvent::PARTNER_REMOVED, cells.clock.now()));
    ends.back().id = std::max(atom->tag[i], other);
    ends.back().other = std::min(atom->tag[i], other);
  }
  return SkinCellEvent::gather(ends, world);
}

/* ----------------------------------------------------------------------
   end a dividing pair for those of its cells that I own
------------------------------------------------------------------------- */

void SkinDividingPairs::dissolve(const SkinCellEvent &event)
{
  const bool bonded = have_bond(event.id, event.other);
  for (const auto &[id, other] : {std::pair(event.id, event.other), {event.other, event.id}}) {
    const int i = cells.owned_index(id);
    if (i < 0) continue;
    cells.state.pair[i] = 0;
    if (!bonded) show(i, other);
    if (cells.state.next_division[i] >= 0.0)
      cells.state.next_division[i] = std::max(cells.state.next_division[i], event.time);
  }
}

/* ----------------------------------------------------------------------
   both cells of a dividing pair name each other, on whatever ranks they are, unless another
   command has removed one of them
------------------------------------------------------------------------- */

void SkinDividingPairs::check() const
{
  std::vector<tagint> mine, named;
  for (int i = 0; i < atom->nlocal; i++)
    if (cells.kind_of(i) != SkinCells::NONE && cells.state.pair[i]) {
      mine.push_back(atom->tag[i]);
      mine.push_back(cells.state.pair[i]);
    }
  const std::vector<tagint> told = skin_gather(mine, world);

  std::vector<std::pair<tagint, tagint>> all;
  for (size_t k = 0; k < told.size(); k += 2) {
    all.emplace_back(told[k], told[k + 1]);
    named.push_back(told[k + 1]);
  }
  std::sort(all.begin(), all.end());
  std::sort(named.begin(), named.end());
  const std::vector<tagint> gone = missing_ids(named);
  for (const auto &[id, other] : all)
    if (!std::binary_search(all.begin(), all.end(), std::pair(other, id)) &&
        !std::binary_search(gone.begin(), gone.end(), other))
      error->all(FLERR, "Fix skin/cells: cell {} is paired with {}, which is no cell that is "
                 "paired with it", id, other);
}

/* ----------------------------------------------------------------------
   those of the IDs, which all ranks give alike, that no atom has
------------------------------------------------------------------------- */

std::vector<tagint> SkinDividingPairs::missing_ids(const std::vector<tagint> &ids) const
{
  std::vector<int> owned, anywhere(ids.size());
  for (tagint id : ids) owned.push_back(cells.owned_index(id) >= 0);
  MPI_Allreduce(owned.data(), anywhere.data(), (int) ids.size(), MPI_INT, MPI_MAX, world);
  std::vector<tagint> gone;
  for (size_t k = 0; k < ids.size(); k++)
    if (!anywhere[k]) gone.push_back(ids[k]);
  return gone;
}

/* ----------------------------------------------------------------------
   whether the user has put a bond between the cells of a pair, on whatever rank it is stored
------------------------------------------------------------------------- */

bool SkinDividingPairs::have_bond(tagint id, tagint other) const
{
  int mine = 0, anywhere;
  for (const auto &[one, two] : {std::pair(id, other), {other, id}}) {
    const int i = cells.owned_index(one);
    const int n = i < 0 ? 0 : atom->num_bond[i];
    const tagint *const bonds = n ? atom->bond_atom[i] : nullptr;
    if (n && std::find(bonds, bonds + n, two) != bonds + n) mine = 1;
  }
  MPI_Allreduce(&mine, &anywhere, 1, MPI_INT, MPI_MAX, world);
  return anywhere;
}

/* ----------------------------------------------------------------------
   whether the user has given a cell of mine a bond, stored with it or with the other
------------------------------------------------------------------------- */

bool SkinDividingPairs::is_bonded(int i) const
{
  const int own = cells.state.pair[i] != 0;
  const int j = own ? cells.owned_index(cells.state.pair[i]) : -1;
  return atom->num_bond[i] > 0 || atom->nspecial[i][0] > own || (j >= 0 && atom->num_bond[j] > 0);
}

/* ----------------------------------------------------------------------
   the cells of a dividing pair are special neighbors of each other, as if there were a bond
   between them: the pair styles do not see them. Those that are special for a bond stay.
------------------------------------------------------------------------- */

void SkinDividingPairs::hide(int i, tagint other)
{
  int *const n = atom->nspecial[i];
  tagint *const special = atom->special[i], *const end = special + n[0];
  if (std::find(special, end, other) != end) return;
  if (n[2] >= atom->maxspecial)
    error->one(FLERR, "Fix skin/cells: cell {} divides and has {} special neighbors already: use "
               "extra/special/per/atom in read_data or create_box", atom->tag[i], n[2]);
  std::copy_backward(end, special + n[2], special + n[2] + 1);
  *end = other;
  for (int k = 0; k < 3; k++) n[k]++;
}

/* ---------------------------------------------------------------------- */

void SkinDividingPairs::show(int i, tagint other)
{
  int *const n = atom->nspecial[i];
  tagint *const special = atom->special[i];
  tagint *const place = std::find(special, special + n[0], other);
  if (place == special + n[0]) return;
  std::copy(place + 1, special + n[2], place);
  for (int k = 0; k < 3; k++) n[k]--;
}
