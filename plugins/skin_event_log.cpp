#include "skin_event_log.h"

#include "comm.h"
#include "error.h"
#include "utils.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <sys/file.h>
#include <unistd.h>

using namespace LAMMPS_NS;

static const char HEADER[] = "time,kind,id,parent,type,x,y,z,divisions_left,cause\n";

/* ---------------------------------------------------------------------- */

SkinEventLog::~SkinEventLog()
{
  if (fp && fclose(fp) != 0)
    error->warning(FLERR, "Fix skin/cells: cannot close the event log {}: {}", filename,
                   utils::getsyserror());
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::open(bigint position)
{
  if (comm->me != 0 || filename.empty() || fp) return;

  // without the earlier part of the log, the rest of it is still worth having

  const bool missing = access(filename.c_str(), F_OK) != 0;
  start = missing ? -1 : position;
  fp = fopen(filename.c_str(), "a");
  check(fp, missing ? "create" : "continue");
  lock();
  check(fseek(fp, 0, SEEK_END) == 0, "continue");
  if (ftell(fp) < start)
    error->one(FLERR, "Fix skin/cells: the event log {} has {} bytes, but the restart file "
               "continues it at byte {}: it is not the log of this run",
               filename, ftell(fp), start);
  if (missing) begin();
}

/* ----------------------------------------------------------------------
   until this process ends or closes the log; a file system without locks does without
------------------------------------------------------------------------- */

void SkinEventLog::lock()
{
  if (flock(fileno(fp), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    error->one(FLERR, "Fix skin/cells: another simulation writes the event log {}", filename);
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::begin()
{
  if (!fp || begun) return;
  begun = true;
  const bigint length = std::max(start, (bigint) 0);
  check(ftruncate(fileno(fp), length) == 0 && fseek(fp, 0, SEEK_END) == 0, "continue");
  if (start < 0) check(fputs(HEADER, fp) >= 0, "write");
  check(fputs(waiting.c_str(), fp) >= 0, "write");
  waiting.clear();
  flush();
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::begin_if_waiting()
{
  if (!waiting.empty()) begin();
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::write(double time, const char *kind, tagint id, tagint parent, int type,
                         const double *x, int divisions_left, const char *cause)
{
  if (!fp) return;
  waiting += fmt::format("{:.10g},{},{},{},{},{:.10g},{:.10g},{:.10g},{},{}\n", time, kind, id,
                         parent, type, x[0], x[1], x[2], divisions_left, cause);
  if (!begun) return;
  check(fputs(waiting.c_str(), fp) >= 0, "write");
  waiting.clear();
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::flush()
{
  if (fp) check(fflush(fp) == 0, "write");
}

/* ---------------------------------------------------------------------- */

bigint SkinEventLog::sync()
{
  if (!fp) return -1;
  begin();
  flush();
  check(fsync(fileno(fp)) == 0, "write");
  return ftell(fp);
}

/* ---------------------------------------------------------------------- */

bigint SkinEventLog::position(bigint told) const
{
  if (!fp) return told;
  return begun ? ftell(fp) : start;
}

/* ---------------------------------------------------------------------- */

std::string SkinEventLog::path() const
{
  char *const found = realpath(filename.c_str(), nullptr);
  const std::string full = found ? found : filename;
  free(found);
  return full;
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::check(bool ok, const char *action)
{
  if (!ok)
    error->one(FLERR, "Fix skin/cells: cannot {} the event log {}: {}", action, filename,
               utils::getsyserror());
}
