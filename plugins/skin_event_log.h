// events.csv: one line for each birth, death and end of a division, in the order of their times.

#ifndef LMP_SKIN_EVENT_LOG_H
#define LMP_SKIN_EVENT_LOG_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class SkinEventLog : protected Pointers {
 public:
  explicit SkinEventLog(class LAMMPS *lmp) : Pointers(lmp), fp(nullptr) {}
  ~SkinEventLog() override;

  void set_file(const char *name) { filename = name; }

  // start a new file, or continue one after cutting off what follows the restart file's position

  void open();
  void resume(bigint position);

  void write(double time, const char *kind, tagint id, tagint parent, int type, const double *x,
             int divisions_left, const char *cause);

  // hand what was written to the system, so that others see it

  void flush();

  // bring it to disk, return the length of the file on rank 0, -1 if there is no log

  bigint sync();

 private:
  std::string filename;
  FILE *fp;

  void check(bool ok, const char *action);
};

}    // namespace LAMMPS_NS

#endif
