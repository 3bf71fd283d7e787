// Arguments of a command, read keyword by keyword. Each value is checked; errors name its keyword.

#ifndef LMP_SKIN_ARGUMENTS_H
#define LMP_SKIN_ARGUMENTS_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class SkinArguments : protected Pointers {
 public:
  enum Allowed { FINITE, NOT_NEGATIVE, POSITIVE };

  SkinArguments(class LAMMPS *lmp, const std::string &command, int narg, char **arg) :
      Pointers(lmp), subject(command), narg(narg), arg(arg), next(0) {}

  bool at_end() const { return next >= narg; }
  int used() const { return next; }
  std::string following() const { return at_end() ? "" : arg[next]; }

  // what errors speak of from now on

  std::string about() const { return subject; }
  void speak_of(const std::string &what) { subject = what; }

  // the keyword and one of its values, in errors

  std::string named(const std::string &part) const;

  // take the next word as a keyword that n values must follow

  const std::string &keyword();
  void need(int n) const;

  // take the next value; the name of one of several is that of the keyword and this part

  std::string word();
  double number(Allowed, const std::string &part = "");
  double number_above(double bound, const std::string &part = "");
  bigint integer(bigint least, bigint most = MAXSMALLINT);
  int atom_type();

 private:
  std::string subject, key;
  int narg;
  char **arg;
  int next;
};

}    // namespace LAMMPS_NS

#endif
