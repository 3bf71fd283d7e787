// Interventions: what is done to cells at times that the keyword `intervene` of fix skin/cells
// tells in advance. This is what is due at a time and which cells it concerns; the fix does it.

#ifndef LMP_SKIN_INTERVENTIONS_H
#define LMP_SKIN_INTERVENTIONS_H

#include "pointers.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class SkinArguments;
class SkinCellKinds;

struct SkinIntervention {
  enum Action { REMOVE, CONVERT, ADD, CHANGE };

  struct Region {
    enum Shape { CYLINDER, HALF_SPACE } shape;
    double value[4];    // x, y and radius, or a normal and an offset
  };

  struct Place {
    double x[3];
    bool on_membrane;    // the cell touches the membrane from above: the height follows from x, y
  };

  std::string name;
  Action action = CHANGE;
  double first = 0.0;              // time
  double period = 0.0;             // 0 if it happens once
  double until = INFINITY;         // latest time
  std::string from_name, to_name;    // kinds as they are given: of the cells, what they become
  double fraction = 1.0;           // of the cells of the kind in the regions
  std::vector<Region> regions;
  std::vector<Place> places;       // of added cells

  std::vector<bool> from;    // by kind: whether its cells are concerned
  int to = 0;                // kind that they become, or that added cells are of

  double time(int64_t occurrence) const { return first + (double) occurrence * period; }
  bool has(int64_t occurrence) const;
};

class SkinInterventions : protected Pointers {
 public:
  // an intervention happens once for each of its times

  struct Due {
    const SkinIntervention *what;
    int64_t occurrence;

    // of its random numbers

    uint64_t key() const;
  };

  explicit SkinInterventions(class LAMMPS *lmp) : Pointers(lmp), past(-INFINITY) {}

  // read what follows the keyword `intervene`; look up kinds when all of them are read

  void add(SkinArguments &);
  void complete(const SkinCellKinds &);

  // the time is this when the first run begins: what is earlier does not happen

  void begin(double time);

  // what happens by this time and has not happened yet, in order

  std::vector<Due> due(double time) const;

  // all that was due by this time has happened

  void pass(double time);

  // what a restart file stores for that

  double passed() const { return past; }
  void resume_after(double stored) { past = stored; }

  // whether it happens to a cell, at a place within the box

  bool concerns(const Due &, bigint seed, int kind, tagint id, const double *x) const;

 private:
  std::vector<SkinIntervention> list;
  double past;    // what was due by then has happened

  double latest(double time) const;
  double low(int dimension) const;
  double high(int dimension) const;
  void read_times(SkinArguments &, SkinIntervention &) const;
  void read_action(SkinArguments &, SkinIntervention &) const;
  void read_choice(SkinArguments &, SkinIntervention &) const;
  void read_places(SkinArguments &, SkinIntervention &) const;
  double read_coordinate(SkinArguments &, int dimension) const;
  bool inside(const SkinIntervention::Region &, const double *x) const;
};

}    // namespace LAMMPS_NS

#endif
