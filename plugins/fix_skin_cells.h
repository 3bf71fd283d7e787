#ifndef LMP_FIX_SKIN_CELLS_H
#define LMP_FIX_SKIN_CELLS_H

#include "fix.h"

#include "skin_cell_events.h"
#include "skin_cell_kinds.h"
#include "skin_cell_state.h"
#include "skin_event_log.h"
#include "skin_interventions.h"
#include "skin_nearest.h"
#include "skin_random.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixSkinCells : public Fix {
 public:
  FixSkinCells(class LAMMPS *, int, char **);
  ~FixSkinCells() override;
  int setmask() override;
  int modify_param(int, char **) override;
  void post_constructor() override;
  void init() override;
  void setup_pre_neighbor() override;
  void setup_pre_reverse(int, int) override;
  void setup(int) override;
  void pre_exchange() override;
  void pre_neighbor() override;
  void pre_reverse(int, int) override;
  void min_pre_neighbor() override;
  void min_pre_reverse(int, int) override;
  void end_of_step() override;
  void post_run() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double memory_usage() override;

  // for integrators that compute forces within a step

  void within_step(double);
  void forget_detached_after(double);
  bool any_astray();

  // some or all of the forces of this fix

  enum Forces { ATTACHMENT = 1, SPRINGS = 2 };
  void add_forces(int which, int eflag = 0, int vflag = 0);

 private:
  static constexpr int NONE = 0;    // kind of what is no cell
  enum Term { ADHESION, BINDING, DIVISION, NTERMS };
  static constexpr int NCOLUMNS = 8;    // of the per-atom array
  static constexpr int NSTORED = 6;     // values in a restart file, of which the first is this:
  static constexpr double RESTART_FORMAT = -2.0;

  // settings

  bigint seed;
  int membrane_type;
  SkinCellKinds kinds;
  double contact;                                        // cell-membrane contact length
  double core;                                           // closest that a cell may come to it
  double spring_stiffness, spring_start, spring_rate;    // division spring
  double spring_end;                                     // its length when the division ends
  double half_separation;                                // of a newborn pair
  bool pairs_stay;                                       // no cell of a pair leaves
  double apart;                                          // least distance at the end of a pair
  int every;                                             // steps between event steps
  int inherited_groups;    // bits of groups in which a daughter is if her mother is

  // state

  bigint next_id;    // of a newborn; may be one more than an ID can be
  bigint births, deaths;
  SkinCellState state;
  SkinInterventions interventions;
  SkinEventLog log;
  bigint log_position;    // where the log stood when the restart file was written, or -1
  double setup_time;      // time at the setup of this run or minimisation
  double time_offset;     // from the end of the step to a stage within it
  bigint known_atoms;     // if no other command has made or removed any in this run

  SkinNearest nearest;
  std::vector<int> cells;    // local indices of my cells since the last neighbor build
  std::vector<char> parted;  // which of them were far enough from the other cell of their pair
  double energy[NTERMS], energy_all[NTERMS];
  bool energy_summed;
  int nmax;           // rows of array_atom
  bool rearranged;    // atoms have come, gone or changed places since cells were listed
  std::string looked_at;    // data file and section that have been found to be there

  // settings and checks

  void parse(int, char **);
  void refresh_state();
  int kind_of(int) const;
  int local_index(tagint) const;
  int owned_index(tagint) const;
  void check_cell(int) const;
  void check_pairs() const;
  void check_others() const;
  void check_reach() const;
  double ghost_cutoff() const;
  double time_of_step(bigint) const;
  double now() const;
  std::vector<double> to_restart();
  void from_restart(const double *);
  bool is_first() const;
  class FixSkinCellsRecord *find_record() const;
  void take_record();
  void leave_record();

  // atoms that come, go and change places

  std::string section_that_is_read() const;
  void check_section(int, const std::string &);
  void set_row(int, const double *);
  void start_created_cell(int);
  void list_cells();
  void migrate(bool);

  // forces

  void attach(int, const SkinNearest::Neighbor &);
  double reach() const;
  std::string remedy() const;
  void lost(int, double) const;
  void pierced(int, const SkinNearest::Neighbor &, double) const;
  double pull_pair(int);
  int partner_of(int) const;
  double stiffness_of(int) const;
  void tally_energy(int, int, double);
  void add_pair_force(int, int, double);
  void write_row(int, const SkinNearest::Neighbor &);

  // events

  void schedule_first(int);
  double wait(const SkinCellKind &, tagint, uint64_t,
              SkinRandom::Purpose = SkinRandom::WAIT) const;
  double next_division(int, double, int) const;
  double pair_end_time(int) const;
  double distance_in_pair(int) const;
  std::vector<SkinCellEvent> grown_pairs() const;
  bool detached(int) const;
  bool divides_by(int, double) const;
  void plan_events(bigint);
  std::vector<SkinCellEvent> due_events(const std::vector<SkinCellEvent> &) const;
  SkinCellEvent death_of(int) const;
  void remove(const SkinCellEvent &);
  void log_event(const SkinCellEvent &, const char *, tagint, tagint, const std::string &);

  // dividing pairs

  SkinCellEvent end_of_pair(int, double, int) const;
  std::vector<SkinCellEvent> pairs_ended_by(const std::vector<SkinCellEvent> &) const;
  std::vector<tagint> missing_ids(const std::vector<tagint> &) const;
  void end_widowed_pairs();
  void dissolve(const SkinCellEvent &, bool);
  bool have_bond(tagint, tagint) const;
  void hide(int, tagint);
  void show(int, tagint);

  // births

  SkinCellEvent division_of(int, double, const SkinNearest::Neighbor &) const;
  void middle_of_subdomain(double *) const;
  void skip_used_ids();
  tagint new_id();
  void give_birth(const std::vector<SkinCellEvent> &);
  void divide_mother(int, const SkinCellEvent &, tagint);
  void start_daughter(int, const SkinCellEvent &);

  // interventions

  void intervene();
  std::vector<int> concerned(const SkinInterventions::Due &) const;
  void remove_cells(const SkinInterventions::Due &);
  void convert_cells(const SkinInterventions::Due &);
  void add_cells(const SkinInterventions::Due &);
  void log_change(const SkinInterventions::Due &);
  void start_added_cell(int, const SkinCellKinds::Stage &);
  double height_on_membrane(const double *, const std::string &) const;
  void check_room(const double *, const std::string &) const;
};

}    // namespace LAMMPS_NS

#endif
