#ifndef LMP_FIX_SKIN_CELLS_H
#define LMP_FIX_SKIN_CELLS_H

#include "fix.h"

#include "skin_attachment.h"
#include "skin_cells.h"
#include "skin_dividing_pairs.h"
#include "skin_divisions.h"
#include "skin_interventions.h"
#include "skin_lineage.h"
#include "skin_state_section.h"

#include <cmath>
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
  void setup_pre_force(int) override;
  void setup_pre_reverse(int, int) override;
  void post_integrate() override;
  void pre_exchange() override;
  void pre_neighbor() override;
  void pre_force(int) override;
  void pre_reverse(int, int) override;
  void post_force(int) override { put_back_left(); }
  void min_pre_neighbor() override;
  void min_pre_force(int) override;
  void min_pre_reverse(int, int) override;
  void min_post_force(int) override { put_back_left(); }
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

  // for integrators that compute forces within a step: forces until the next call are those at this
  // time, counted from the end of the step; and what was seen after a time did not happen

  void within_step(double offset) { cells.clock.set_within_step(offset); }
  void forget_detached_after(double offset);

  // cells that have left before, which no force knows of, out of the reach of all others, and back
  // where they are

  void take_away_left();
  void put_back_left();
  bool any_astray() { return attachment.any_astray(); }

  // some or all of the forces of this fix

  enum Forces { ATTACHMENT = 1, SPRINGS = 2 };
  void add_forces(int which, int eflag = 0, int vflag = 0);
  void find_nearest();    // which they need, if positions are not those of the last forces

 private:
  enum Term { ADHESION, BINDING, DIVISION, NTERMS };
  enum Count { PAIRS = SkinCellKinds::NFIRST, BIRTHS, DEATHS, NEXT_ID, NCOUNTS };
  static constexpr int NCOLUMNS = 8;    // of the per-atom array

  SkinCells cells;
  SkinDividingPairs pairs;
  SkinDivisions divisions;
  SkinAttachment attachment;
  SkinInterventions interventions;
  SkinLineage lineage;
  SkinStateSection state_section;

  int every;                   // steps between event steps
  std::vector<SkinNearest::Neighbor> closest;    // to the cells of the list
  std::vector<char> parted;    // which cells of the list are far enough from that of their pair
  std::vector<double> away;    // heights of those that are out of reach of forces, or NaN
  int any_away;                // whether there are any on any rank
  double energy[NTERMS], energy_all[NTERMS];
  bool energy_summed;
  int nmax;           // rows of array_atom
  bool rearranged;    // atoms have come, gone or changed places since cells were listed
  bool reach_checked;    // that of ghost particles, for the kinds of cells as they are

  void parse(int, char **);
  void begin_to_count(int kind);
  void check_settings() const;
  void check_others() const;
  bool is_first() const;
  template <class CONDITION> int count(const CONDITION &);

  // atoms that come, go and change places

  void set_row(int, const double *);
  void start_created_cell(int);
  void list_cells();
  void end_widowed_pairs();
  void migrate(bool);

  // forces

  bool is_away(size_t k) const { return !std::isnan(away[k]); }
  void attach(int, const SkinNearest::Neighbor &);
  double pull_pair(int);
  void tally(int, int, double, const double *, double, double);
  void write_row(int, const SkinNearest::Neighbor &);

  // events

  std::vector<SkinCellEvent> deaths_and_births(const std::vector<SkinCellEvent> &) const;
  void remove(const SkinCellEvent &);

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
