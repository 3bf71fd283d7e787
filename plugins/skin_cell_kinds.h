// The kinds of cells: one row of a table for each, as the arguments of fix skin/cells give it. What
// cells do follows from the values of a row, never from its name.

#ifndef LMP_SKIN_CELL_KINDS_H
#define LMP_SKIN_CELL_KINDS_H

#include "pointers.h"

#include <cmath>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class SkinArguments;

struct SkinCellKind {
  static constexpr int ENDLESS = -1;

  enum Law { NO_LAW, BOUND, ADHESIVE };

  std::string name;
  int type = 0;                  // atom type
  int number = 0;                // in the event log, 0 if not given
  Law law = NO_LAW;              // of its attachment to the membrane
  double stiffness = 0.0;        // K of the law
  double range = INFINITY;       // lambda of the law: its force ends at this contact length
  double detachment = INFINITY;  // a cell that is further away leaves
  double cycle_delay = 0.0;      // T0
  double cycle_rate = 0.0;       // gamma, 0 without a cycle
  double first_phase = 0.0;      // largest time that has elapsed in a first cycle
  int generations = ENDLESS;     // divisions of a cell that enters this kind
  std::string daughter_name, last_name, paired_name;
  double paired_stiffness = 0.0;    // K in a dividing pair with a cell of that kind

  // places in the table, 0 if none: the newborn, after the last division, of the other cell

  int daughter = 0, last = 0, paired = 0;
  bool spent = false;    // never divides, and cells have become it by their last division

  bool divides() const { return daughter != 0; }
  bool limited() const { return divides() && generations != ENDLESS; }
  bool detaches() const { return detachment < INFINITY; }

  // the membrane pulls at its cells however far they are

  bool always_pulled() const { return law == BOUND && !detaches(); }
};

class SkinCellKinds : protected Pointers {
 public:
  // a cell's kind and the divisions that it has left

  struct Stage {
    int kind, divisions_left;
  };

  explicit SkinCellKinds(class LAMMPS *);

  // read the row that follows the keyword `kind`; link and check rows when all are read

  void add(SkinArguments &);
  void add(const SkinCellKind &);
  void complete();

  // those rows that have no number get theirs by their place

  void number_from(int first);

  // read a name and other values of that row, which is returned

  int change(SkinArguments &);

  // 0 is what is no cell, rows are numbered from 1

  int size() const { return (int) rows.size() - 1; }
  int of_type(int type) const { return kind_of_type[type]; }
  int find(const std::string &name) const;
  const SkinCellKind &operator[](int kind) const { return rows[kind]; }

  // kind with that number, 0 if there is none; those with none of the first four numbers

  static constexpr int FIRST_NUMBER = 3, NFIRST = 4;
  int of_number(int number) const;
  std::vector<int> of_other_numbers() const;

  // longest distance, in contact lengths, at which a kind that does not stay has a force or leaves

  double longest_range() const;

  // what a cell is that enters a kind

  Stage enter(int kind) const;

  // what a cell is after one of its divisions, and what its newborn is

  Stage after_division(const Stage &mother) const;
  Stage newborn(const Stage &mother) const;

 private:
  std::vector<SkinCellKind> rows;
  std::vector<int> kind_of_type;

  void read(SkinArguments &, SkinCellKind &, bool first);
  void read_law(SkinArguments &, SkinCellKind &) const;
  int link(const SkinCellKind &, const std::string &keyword, const std::string &name) const;
  void check(const SkinCellKind &) const;
  bool never_enters(int kind) const;
};

}    // namespace LAMMPS_NS

#endif
