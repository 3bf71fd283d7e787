#include "skin_event_log.h"

#include "comm.h"
#include "error.h"
#include "utils.h"

#include <cerrno>
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

void SkinEventLog::open()
{
  if (comm->me != 0 || filename.empty() || fp) return;
  fp = fopen(filename.c_str(), "w");
  check(fp && fputs(HEADER, fp) >= 0, "create");
  flush();
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::resume(bigint position)
{
  if (comm->me != 0 || filename.empty() || fp) return;
  fp = fopen(filename.c_str(), "r+");

  // without the earlier part of the log, the rest of it is still worth having

  if (!fp && errno == ENOENT) {
    open();
    return;
  }
  check(fp && fseek(fp, 0, SEEK_END) == 0, "continue");
  if (ftell(fp) < position)
    error->one(FLERR, "Fix skin/cells: the event log {} has {} bytes, but the restart file "
               "continues it at byte {}: it is not the log of this run",
               filename, ftell(fp), position);
  check(ftruncate(fileno(fp), position) == 0 && fseek(fp, 0, SEEK_END) == 0, "continue");
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::write(double time, const char *kind, tagint id, tagint parent, int type,
                         const double *x, int divisions_left, const char *cause)
{
  if (!fp) return;
  check(fprintf(fp, "%.10g,%s,%d,%d,%d,%.10g,%.10g,%.10g,%d,%s\n", time, kind, (int) id,
                (int) parent, type, x[0], x[1], x[2], divisions_left, cause) > 0,
        "write");
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
  flush();
  check(fsync(fileno(fp)) == 0, "write");
  return ftell(fp);
}

/* ---------------------------------------------------------------------- */

void SkinEventLog::check(bool ok, const char *action)
{
  if (!ok)
    error->one(FLERR, "Fix skin/cells: cannot {} the event log {}: {}", action, filename,
               utils::getsyserror());
}
