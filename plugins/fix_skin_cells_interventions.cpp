// interventions in fix skin/cells: cells that are removed, converted and added at given times

#include "fix_skin_cells.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "library.h"

#include <algorithm>
#include <cmath>
#include <set>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   what is due now, after all other events of the step: each on the state that the former left
------------------------------------------------------------------------- */

void FixSkinCells::intervene()
{
  for (const SkinInterventions::Due &due : interventions.due(cells.clock.now())) {
    migrate(true);
    pre_neighbor();
    switch (due.what->action) {
      case SkinIntervention::REMOVE: remove_cells(due); break;
      case SkinIntervention::CONVERT: convert_cells(due); break;
      case SkinIntervention::ADD: add_cells(due); break;
      case SkinIntervention::CHANGE: log_change(due); break;
    }
    lineage.log.flush();
  }
  interventions.pass(cells.clock.now());
}

/* ----------------------------------------------------------------------
   my cells that an intervention concerns
------------------------------------------------------------------------- */

std::vector<int> FixSkinCells::concerned(const SkinInterventions::Due &due) const
{
  std::vector<int> found;
  for (int i : cells.list)
    if (interventions.concerns(due, divisions.seed, cells.kind_of(i), atom->tag[i], atom->x[i]))
      found.push_back(i);
  return found;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::remove_cells(const SkinInterventions::Due &due)
{
  std::vector<SkinCellEvent> removals;
  for (int i : concerned(due))
    removals.push_back(cells.event(i, SkinCellEvent::DEATH, cells.clock.now()));
  removals = SkinCellEvent::gather(removals, world);
  if (removals.empty()) return;
  const std::vector<SkinCellEvent> ends = SkinCellEvent::gather(pairs.ended_by(removals), world);

  for (const SkinCellEvent &event : removals) {
    lineage.write(event, "removal", event.id, event.parent, due.what->name);
    remove(event);
  }
  std::set<tagint> dissolved;
  for (const SkinCellEvent &event : ends)
    if (dissolved.insert(event.id).second) {
      pairs.dissolve(event);
      lineage.write(event, "division_end", event.id, event.other, "partner_removed");
    }
  atom->natoms -= (bigint) removals.size();
  cells.known_atoms -= (bigint) removals.size();
  migrate(false);
}

/* ----------------------------------------------------------------------
   cells enter another kind as newborns do, and begin a cycle
------------------------------------------------------------------------- */

void FixSkinCells::convert_cells(const SkinInterventions::Due &due)
{
  const SkinCellKinds::Stage stage = cells.kinds.enter(due.what->to);
  std::vector<SkinCellEvent> conversions;
  for (int i : concerned(due)) {
    if (cells.kind_of(i) == stage.kind) continue;
    atom->type[i] = cells.kinds[stage.kind].type;
    cells.state.divisions_left[i] = stage.divisions_left;
    cells.state.detached_time[i] = SkinCellState::NEVER;
    divisions.schedule_converted(i, due.key());
    conversions.push_back(cells.event(i, SkinCellEvent::DEATH, cells.clock.now()));
  }
  for (const SkinCellEvent &event : SkinCellEvent::gather(conversions, world))
    lineage.write(event, "conversion", event.id, event.parent, due.what->name);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::add_cells(const SkinInterventions::Due &due)
{
  const SkinCellKinds::Stage stage = cells.kinds.enter(due.what->to);
  atom->nghost = 0;
  lineage.skip_used_ids();
  for (const SkinIntervention::Place &place : due.what->places) {
    SkinCellEvent event = {};
    event.time = cells.clock.now();
    event.cell = stage;
    std::copy(place.x, place.x + 3, event.x);
    domain->remap(event.x);
    if (place.on_membrane) event.x[2] = height_on_membrane(event.x, due.what->name);
    check_room(event.x, due.what->name);
    event.id = lineage.new_id();
    const int type = cells.kinds[stage.kind].type;
    lammps_create_atoms(lmp, 1, &event.id, &type, event.x, nullptr, nullptr, 0);
    cells.find_state();
    const int i = cells.owned_index(event.id);
    if (i >= 0) start_added_cell(i, stage);
    lineage.write(event, "addition", event.id, 0, due.what->name);
    cells.known_atoms++;
  }
}

/* ----------------------------------------------------------------------
   what is changed, and how, is the matter of the input script
------------------------------------------------------------------------- */

void FixSkinCells::log_change(const SkinInterventions::Due &due)
{
  const double nowhere[3] = {};
  lineage.log.write(cells.clock.now(), "change", 0, 0, 0, nowhere, 0, due.what->name.c_str());
}

/* ----------------------------------------------------------------------
   like a cell of the initial state
------------------------------------------------------------------------- */

void FixSkinCells::start_added_cell(int i, const SkinCellKinds::Stage &stage)
{
  SkinCellState &state = cells.state;
  atom->mask[i] |= groupbit;
  state.clear(i);
  state.divisions_left[i] = stage.divisions_left;
  state.next_division[i] = SkinCellState::NEVER;
  state.birth_time[i] = cells.clock.now();
  state.detached_time[i] = SkinCellState::NEVER;
  if (cells.row_of(i).divides()) divisions.schedule_first(i);
}

/* ----------------------------------------------------------------------
   the lowest height from which up a cell over this place is in contact with no membrane particle
------------------------------------------------------------------------- */

double FixSkinCells::height_on_membrane(const double *place, const std::string &name) const
{
  const double contact = attachment.contact;
  double height = -INFINITY, height_all;
  for (int i = 0; i < atom->nlocal; i++) {
    if (atom->type[i] != attachment.membrane_type) continue;
    double delta[3] = {place[0] - atom->x[i][0], place[1] - atom->x[i][1], 0.0};
    domain->minimum_image(FLERR, delta);
    const double rest = contact * contact - delta[0] * delta[0] - delta[1] * delta[1];
    if (rest >= 0.0) height = std::max(height, atom->x[i][2] + std::sqrt(rest));
  }
  MPI_Allreduce(&height, &height_all, 1, MPI_DOUBLE, MPI_MAX, world);
  if (!std::isfinite(height_all))
    error->all(FLERR, "Fix skin/cells intervene {}: no membrane particle is within {} of the place "
               "{} {}", name, contact, place[0], place[1]);
  return height_all;
}

/* ----------------------------------------------------------------------
   an added cell must be in the box, and overlap with no other cell and with no membrane particle
------------------------------------------------------------------------- */

void FixSkinCells::check_room(const double *place, const std::string &name) const
{
  if (!(place[2] < domain->boxhi[2]))
    error->all(FLERR, "Fix skin/cells intervene {}: a cell at {} {} {} would be above the box, "
               "which ends at {}", name, place[0], place[1], place[2], domain->boxhi[2]);

  double closest[2] = {INFINITY, INFINITY}, closest_all[2];    // cell, membrane particle
  for (int i = 0; i < atom->nlocal; i++) {
    const bool membrane = atom->type[i] == attachment.membrane_type;
    if (!membrane && cells.kind_of(i) == SkinCells::NONE) continue;
    double delta[3];
    for (int d = 0; d < 3; d++) delta[d] = place[d] - atom->x[i][d];
    domain->minimum_image(FLERR, delta);
    const double r = std::sqrt(delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]);
    closest[membrane] = std::min(closest[membrane], r);
  }
  MPI_Allreduce(closest, closest_all, 2, MPI_DOUBLE, MPI_MIN, world);

  static const char *const what[2] = {"another cell", "a membrane particle"};
  const double least[2] = {pairs.full_length(), attachment.contact};
  for (int k = 0; k < 2; k++)
    if (closest_all[k] < least[k] * (1.0 - 1.0e-9))
      error->all(FLERR, "Fix skin/cells intervene {}: a cell at {} {} {} would be {} from {}, must "
                 "be at least {}", name, place[0], place[1], place[2], closest_all[k], what[k],
                 least[k]);
}
