#ifndef LMP_FIX_SKIN_MOTION_H
#define LMP_FIX_SKIN_MOTION_H

#include "fix.h"

#include "skin_build.h"
#include "skin_stages.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixSkinMotion : public Fix {
 public:
  FixSkinMotion(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_force(int) override;
  void setup(int) override;
  void initial_integrate(int) override;
  void post_integrate() override;
  void pre_force(int) override;
  void final_integrate() override;
  void post_run() override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  double compute_vector(int) override;
  double memory_usage() override;

  bool begins_disturbed() const;

  // parts of half of the neighbor skin that particles of each type may go from where neighbor lists
  // found them, before these are built anew; none if lists need not be made for less than all of it

  std::vector<double> margins;

 private:
  SkinStages method;
  double largest_move;           // of any particle in one part of a step, infinite without limit
  double stiffness_limit;        // of a membrane particle that moves at full speed, or infinite
  double shortest_link, longest_link;    // of any bond, for bond styles that do not say whose it is
  double rounding;               // of positions, on every multiple of so many steps, or 0
  bigint round_every;
  class FixSkinCells *cells;     // told the times of stages, if there is one
  class BondSkinStretch *stretch;    // asked for broken links, if it is the bond style
  class DihedralSkinBend *bend;  // asked for inverted triangles after a step, if there is one
  std::vector<class PairSkinBase *> pairs;    // asked for overlaps after a step

  // one part of a step

  std::vector<double> start, start_force, before;    // positions, forces; those two stages ago
  std::vector<double> stiffness;                     // of owned and ghost particles
  std::vector<double> mobility, start_mobility;      // of owned ones; the latter with order 2 alone

  // positions at the neighbor build that the lists belong to

  std::vector<double> listed;
  std::vector<double> marginsq;    // of each type at that build, squared
  SkinBuild build;

  struct Term {
    std::string name;
    std::function<void()> compute;
    int every = 1;    // steps between those on which it works
  };
  std::vector<Term> unproven;    // computed once more to see whether it is the same

  // whether there was a run since the last set-up, how it left the atoms, and how the next found
  // them

  bool left;
  uint64_t left_as;
  bool disturbed;

  // what happened since the fix was defined

  bigint steps, divided, parts, evaluations;
  bigint limited;            // particles with a lower mobility, summed over parts
  double slowest;            // lowest mobility of any
  bigint beyond;             // particles that the neighbor lists do not reach, summed over stages
  bigint beyond_before;      // at the begin of this run
  bigint within_steps;       // evaluations in this run but the last ones of steps
  double furthest_listed;    // from where lists were built, in this run, in squared margins

  struct Move {
    double length = 0.0;
    int rank = 0;
  };
  Move latest;               // what `furthest` has found last
  int furthest_particle;     // my particle that moved furthest, or -1
  double inverted_time;      // for how long there have been inverted triangles
  bool inverted_at_start;    // since before the first step

  void parse(int, char **);
  bool alone() const;
  bool several() const { return method.stages.size() > 1 || largest_move < INFINITY; }
  bool unmoved(double) const;
  double euler_part(double);
  bool advance(double, double);
  bool ends_in_error();
  Move stage(const SkinStage &, double);
  void advance_each(const SkinStage &, double);
  Move furthest(double);
  void keep_start();
  void restore_start(double);
  void find_pairs();
  void find_mobility();
  void count_limited();
  void note_lists();
  void count_beyond();
  void round_positions();
  void evaluate_forces(double);
  void check_links() const;
  void check_box() const;
  uint64_t state_of_atoms() const;
  void unstable(const Move &, double, bool at_start);
  Term pair_term() const;
  Term fix_term(class Fix *) const;
  std::vector<double> forces_of(const Term &) const;
  void check_repeatable();
  void check_repeatable(const Term &) const;
  std::string largest_term(int, int);
  std::string strongest_pair(int, int);
};

}    // namespace LAMMPS_NS

#endif
