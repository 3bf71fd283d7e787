// events.csv: one line for each event, such as a birth, in the order of their times.

#ifndef LMP_SKIN_EVENT_LOG_H
#define LMP_SKIN_EVENT_LOG_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class SkinEventLog : protected Pointers {
 public:
  explicit SkinEventLog(class LAMMPS *lmp) : Pointers(lmp), fp(nullptr), start(-1), begun(false) {}
  ~SkinEventLog() override;

  void set_file(const char *name) { filename = name; }

  // take the file, which no other process may have; it stays as it is until begin()

  void open(bigint position);

  // cut off what follows the restart file's position, all of it if that is negative, and write
  // what has happened before

  void begin();

  // the same, but only if something has happened

  void begin_if_waiting();

  void write(double time, const char *kind, tagint id, tagint parent, int type, const double *x,
             int divisions_left, const char *cause);

  // hand what was written to the system, so that others see it

  void flush();

  // bring it to disk, return the length of the file on rank 0, -1 if there is no log

  bigint sync();

  // where it stands, which is where it was told to until open(), and the full name of its file

  bigint position(bigint told) const;
  std::string path() const;

 private:
  std::string filename;
  std::string waiting;    // lines until begin()
  FILE *fp;
  bigint start;    // length that it has at the beginning of the run
  bool begun;

  void lock();
  void check(bool ok, const char *action);
};

}    // namespace LAMMPS_NS

#endif
