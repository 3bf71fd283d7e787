// dividing pairs in fix skin/cells: that they do not see each other, and their ends

#include "fix_skin_cells.h"

#include "skin_gather.h"

#include "atom.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   local index of an owned or ghost atom, -1 if there is none
------------------------------------------------------------------------- */

int FixSkinCells::local_index(tagint id) const
{
  return id > atom->map_tag_max ? -1 : atom->map(id);
}

/* ---------------------------------------------------------------------- */

int FixSkinCells::owned_index(tagint id) const
{
  const int i = local_index(id);
  return i < atom->nlocal ? i : -1;
}

/* ----------------------------------------------------------------------
   both cells of a dividing pair name each other, on whatever ranks they are, unless another
   command has removed one of them
------------------------------------------------------------------------- */

void FixSkinCells::check_pairs() const
{
  std::vector<tagint> mine, named;
  for (int i = 0; i < atom->nlocal; i++)
    if (kind_of(i) != NONE && state.pair[i]) {
      mine.push_back(atom->tag[i]);
      mine.push_back(state.pair[i]);
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

std::vector<tagint> FixSkinCells::missing_ids(const std::vector<tagint> &ids) const
{
  std::vector<int> owned, anywhere(ids.size());
  for (tagint id : ids) owned.push_back(owned_index(id) >= 0);
  MPI_Allreduce(owned.data(), anywhere.data(), (int) ids.size(), MPI_INT, MPI_MAX, world);
  std::vector<tagint> gone;
  for (size_t k = 0; k < ids.size(); k++)
    if (!anywhere[k]) gone.push_back(ids[k]);
  return gone;
}

/* ----------------------------------------------------------------------
   a pair of which another command has removed a cell is over
------------------------------------------------------------------------- */

void FixSkinCells::end_widowed_pairs()
{
  std::vector<tagint> missing;
  for (int i = 0; i < atom->nlocal; i++)
    if (kind_of(i) != NONE && state.pair[i] && local_index(state.pair[i]) < 0)
      missing.push_back(state.pair[i]);
  const std::vector<tagint> gone = missing_ids(skin_gather(missing, world));
  if (gone.empty()) return;

  std::vector<SkinCellEvent> ends;
  for (int i = 0; i < atom->nlocal; i++) {
    if (kind_of(i) == NONE || std::find(gone.begin(), gone.end(), state.pair[i]) == gone.end())
      continue;
    ends.push_back(end_of_pair(i, now(), SkinCellEvent::PARTNER_REMOVED));
    ends.back().id = std::max(atom->tag[i], state.pair[i]);
    ends.back().other = std::min(atom->tag[i], state.pair[i]);
  }
  for (SkinCellEvent &end : SkinCellEvent::gather(ends, world)) {
    log_event(end, "division_end", end.id, end.other, "partner_removed");
    dissolve(end, false);
  }
  log.flush();
}

/* ----------------------------------------------------------------------
   pairs that end now by growth. With a distance that the two must have, the end is now.
------------------------------------------------------------------------- */

std::vector<SkinCellEvent> FixSkinCells::grown_pairs() const
{
  std::vector<SkinCellEvent> ends;
  for (int i : cells) {
    if (!state.pair[i] || state.pair[i] > atom->tag[i] || !(pair_end_time(i) <= now())) continue;
    if (apart > 0.0 && !(distance_in_pair(i) > apart)) continue;
    ends.push_back(end_of_pair(i, apart > 0.0 ? now() : pair_end_time(i), SkinCellEvent::GROWN));
  }
  return ends;
}

/* ---------------------------------------------------------------------- */

double FixSkinCells::distance_in_pair(int i) const
{
  const double *const x = atom->x[i], *const y = atom->x[partner_of(i)];
  return std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                   (x[2] - y[2]) * (x[2] - y[2]));
}

/* ----------------------------------------------------------------------
   made by the owner of the younger cell of the pair
------------------------------------------------------------------------- */

SkinCellEvent FixSkinCells::end_of_pair(int i, double time, int cause) const
{
  SkinCellEvent event = death_of(i);
  event.kind = cause;
  event.time = time;
  return event;
}

/* ----------------------------------------------------------------------
   my ends of pairs that follow from deaths on any rank
------------------------------------------------------------------------- */

std::vector<SkinCellEvent>
FixSkinCells::pairs_ended_by(const std::vector<SkinCellEvent> &events) const
{
  std::vector<SkinCellEvent> ends;
  for (const SkinCellEvent &event : events) {
    if (event.kind != SkinCellEvent::DEATH || !event.other) continue;
    const int i = owned_index(std::max(event.id, event.other));
    if (i >= 0) ends.push_back(end_of_pair(i, event.time, SkinCellEvent::PARTNER_REMOVED));
  }
  return ends;
}

/* ----------------------------------------------------------------------
   end a dividing pair for those of its cells that I own
------------------------------------------------------------------------- */

void FixSkinCells::dissolve(const SkinCellEvent &event, bool bonded)
{
  for (const auto &[id, other] : {std::pair(event.id, event.other), {event.other, event.id}}) {
    const int i = owned_index(id);
    if (i < 0) continue;
    state.pair[i] = 0;
    if (!bonded) show(i, other);
    if (state.next_division[i] >= 0.0)
      state.next_division[i] = std::max(state.next_division[i], event.time);
  }
}

/* ----------------------------------------------------------------------
   whether the user has put a bond between the cells of a pair, on whatever rank it is stored
------------------------------------------------------------------------- */

bool FixSkinCells::have_bond(tagint id, tagint other) const
{
  int mine = 0, anywhere;
  for (const auto &[one, two] : {std::pair(id, other), {other, id}}) {
    const int i = owned_index(one);
    const int n = i < 0 ? 0 : atom->num_bond[i];
    const tagint *const bonds = n ? atom->bond_atom[i] : nullptr;
    if (n && std::find(bonds, bonds + n, two) != bonds + n) mine = 1;
  }
  MPI_Allreduce(&mine, &anywhere, 1, MPI_INT, MPI_MAX, world);
  return anywhere;
}

/* ----------------------------------------------------------------------
   the cells of a dividing pair are special neighbors of each other, as if there were a bond
   between them: the pair styles do not see them. Those that are special for a bond stay.
------------------------------------------------------------------------- */

void FixSkinCells::hide(int i, tagint other)
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

void FixSkinCells::show(int i, tagint other)
{
  int *const n = atom->nspecial[i];
  tagint *const special = atom->special[i];
  tagint *const place = std::find(special, special + n[0], other);
  if (place == special + n[0]) return;
  std::copy(place + 1, special + n[2], place);
  for (int k = 0; k < 3; k++) n[k]--;
}
