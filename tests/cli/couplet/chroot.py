# SPDX-License-Identifier: Apache-2.0
"""A minimal Debian of its own (debootstrap, as root, from the mirror of this machine's apt; COUPLET_CHROOT names one that is there), and in it the
statements of packaging/Containerfile, one by one. Usage: chroot.py BUILD [package [DEB] | container] [bookworm | trixie]. package: the second image with
cpack's .deb of BUILD: installed by apt, used by a new user, removed. container: the first image's statements, too, which compile everything, and the
commands of the quick start there; its .deb is the one used."""
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from scene import ROOT
from checks import check, end  # noqa: E402

sys.path.append(str(ROOT / "tests/coupling/precice"))
from oscillators_xml import configuration  # noqa: E402

SUITE = sys.argv.pop() if sys.argv[-1] in ("bookworm", "trixie") else "bookworm"
build, what = pathlib.Path(sys.argv[1]), (sys.argv[2:] or ["package"])[0]
MIRROR = "http://deb.debian.org/debian"
PATTERNS = (ROOT / ".dockerignore").read_text().split()
if os.geteuid() != 0 or not shutil.which("debootstrap", path=os.environ["PATH"] + ":/usr/sbin"):
    print("skipped: no debootstrap here, or not root")
    sys.exit(77)


def ignored(folder, names):
    """Those that COPY leaves out: a pattern without **/ counts at the top only."""
    at_top = pathlib.Path(folder) == ROOT
    return {name for name in names for p in PATTERNS if fnmatch.fnmatch(name, p.removeprefix("**/")) and (at_top or p.startswith("**/"))}


class System:
    """A Debian in a folder; /proc and /dev are those of a namespace that ends with each command."""

    def __init__(self, folder, base):
        self.folder = folder
        subprocess.run(["cp", "-a", base, folder], check=True)
        shutil.copy("/etc/resolv.conf", folder / "etc/resolv.conf")
        (folder / "etc/dpkg/dpkg.cfg.d/unsafe-io").write_text("force-unsafe-io\n")  # it need not outlive a power cut

    def run(self, words, user="root", folder="/"):
        home = "/root" if user == "root" else f"/home/{user}"
        enter = ('mount --make-rprivate / && mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev" && mount -t sysfs sys "$0/sys" && '
                 'exec chroot --userspec="$1" "$0" /usr/bin/env -i HOME="$2" LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin sh -c "cd $3 && $4"')
        return subprocess.run(["unshare", "--mount", "--pid", "--fork", "sh", "-c", enter, self.folder, user, home, folder, words], capture_output=True, text=True)

    def must(self, words, **more):
        done = self.run(words, **more)
        check(" ".join(words.split())[:150], done.returncode == 0, (done.stdout[-1500:] + done.stderr[-1500:]) if done.returncode else "")
        return done.stdout

    def named(self):
        """Files that bear the project's name, outside homes and apt's own books."""
        return self.run("find / -xdev \\( -path /proc -o -path /dev -o -path /sys -o -path /home -o -path /tmp -o -path /var/cache/apt -o -path /var/log \\) -prune -o "
                        "-iname '*couplet*' -print -o -path '/usr/share/*couplet/*' -print").stdout.split()


def images():
    """[[(word, arguments)] of each image] of the Containerfile, continued lines joined."""
    text = (ROOT / "packaging/Containerfile").read_text().replace("\\\n", " ")
    found = []
    for word, rest in re.findall(r"^([A-Z]+) (.*)$", text, flags=re.M):
        if word == "FROM":
            found.append([])
        found[-1].append((word, rest))
    return found


def make(system, statements, package):
    """Carries out the statements; (user, entry point)."""
    folder, user, entry = "/", "root", ""
    for word, rest in statements:
        if word == "RUN":
            system.must(rest, user=user, folder=folder)
        elif word == "WORKDIR":
            (system.folder / rest[1:]).mkdir(parents=True, exist_ok=True)
            folder = rest
        elif word == "COPY" and rest.startswith("--from="):
            shutil.copy(package, system.folder / rest.split()[-1][1:])
        elif word == "COPY":
            shutil.copytree(ROOT, system.folder / rest.split()[-1][1:], symlinks=True, ignore=ignored)
        elif word == "USER":
            user = rest
        elif word == "ENTRYPOINT":
            entry = " ".join(eval(rest))
        else:
            check(f"{word} {rest}: a statement that this test knows", word == "CMD" or word == "FROM" and "debian:" in rest)
    return user, entry


def used(system, user, entry):
    """The first minutes of a new user, with an empty home."""
    home = f"/home/{user}"
    check("no path leads to where it was built", str(build) not in system.run("grep -rlIF " + str(build) + " /usr/share/couplet /usr/lib/cmake/couplet_client | head").stdout)
    check("--version", re.match(r"couplet \d+\.\d+\.\d+$", system.must(f"{entry} --version", user=user).strip()))
    said = system.must(f"{entry} doctor", user=user, folder=home)
    check("doctor: self-test of a coupled case", "ok  self-test" in said, said)
    for words in ("gallery", "new mine --from perpendicular-flap --end-time '0.1 s'", "check mine", "explain mine", "run mine -q -n fluid=2", "plot mine/out", "plot mine/out/fluid --field velocity"):
        system.must(f"{entry} {words}", user=user, folder=home)
    pictures = [f for f in (system.folder / home[1:] / "mine/out").rglob("*.png") if f.stat().st_size > 3000]
    check("pictures", len(pictures) > 3, pictures)
    said = system.must("python3 -c \"import couplet; print(couplet.Results('mine/out').fields('fluid').field(-1, 'velocity').shape)\"", user=user, folder=home)
    check("import couplet", said.startswith("("), said)
    said = system.must("bash -c 'source /usr/share/bash-completion/completions/couplet; COMP_CWORD=1; COMP_WORDS=(couplet res); _couplet; echo ${COMPREPLY[*]}'", user=user)
    check("completion", said.strip() == "resume", said)
    system.must("apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends man-db")
    for page in ("couplet", "couplet-run", "fluid_solver"):
        check(f"man {page}", page in system.must(f"man {page}", user=user).lower())


def joined(system, user, entry):
    """Programs of one's own, compiled against the package: C++ and Python beside the fluid, and two on preCICE's interface."""
    home = f"/home/{user}"
    system.must("DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends g++ pkg-config libopenmpi-dev python3-mpi4py")
    for file in ("client/examples/spring_cylinder.cpp", "tests/coupling/precice/oscillators.cpp"):
        shutil.copy(ROOT / file, system.folder / home[1:])
    (system.folder / home[1:] / "precice-config.xml").write_text(configuration("serial-implicit"))
    system.must("chmod a+rw *.cpp *.xml", folder=home)
    system.must("g++ -std=c++20 spring_cylinder.cpp -o spring_cylinder $(pkg-config --cflags --libs couplet_client)", user=user, folder=home)
    for words in ("new cylinder --from spring-cylinder --end-time '0.05 s'", "run cylinder -q", "run cylinder -q --set simulation.output.folder=out-cpp --with body='./spring_cylinder body 2 0 8 0.01'"):
        system.must(f"{entry} {words}", user=user, folder=home)
    found = system.must("PKG_CONFIG_PATH=$(dirname $(find /usr/lib -path '*couplet/precice*' -name libprecice.pc)) pkg-config --cflags --libs libprecice", user=user).strip()
    system.must(f"mpicxx -std=c++20 oscillators.cpp -o oscillators {found}", user=user, folder=home)
    for words in ("import precice-config.xml", "run precice-config.yaml -q --with Left='./oscillators Left precice-config.xml 1' --with Right='./oscillators Right precice-config.xml 1'"):
        system.must(f"{entry} {words}", user=user, folder=home)


def follow(maker):
    """The demo, and all commands of the quick start in one shell, in a checkout with its build."""
    maker.must("apt-get install -q -y --no-install-recommends sudo && echo 'APT::Get::Assume-Yes \"true\";' > /etc/apt/apt.conf.d/yes")
    text = (ROOT / "docs/quickstart.md").read_text()
    (maker.folder / "tmp/quickstart").write_text("\n".join(re.findall(r"^```sh\n(.*?)^```", text, flags=re.M | re.S)))
    maker.must("bash -ex /tmp/quickstart", folder="/couplet")
    check("the picture of the demo", (maker.folder / "couplet/configs/perpendicular-flap/out/perpendicular-flap.png").stat().st_size > 3000)


def removed(system):
    system.must("couplet --version && couplet gallery && python3 -c 'import couplet'")  # as root: Python compiles into the package's folders
    check("installed files bear its name", len(system.named()) > 100)
    system.must("DEBIAN_FRONTEND=noninteractive apt-get purge -q -y couplet")
    left = system.named()
    check("nothing is left", not left, left[:10])


with tempfile.TemporaryDirectory(prefix="couplet-chroot-") as scratch:
    folder = pathlib.Path(scratch)
    base = pathlib.Path(os.environ.get("COUPLET_CHROOT", folder / "base"))
    if not base.exists():
        done = subprocess.run(["debootstrap", "--variant=minbase", SUITE, base, MIRROR], capture_output=True, text=True, env={**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"})
        check("debootstrap", done.returncode == 0, done.stdout[-800:] + done.stderr[-800:] if done.returncode else "")
    first, second = images()
    if what == "container":
        maker = System(folder / "maker", base)
        make(maker, first, None)
        follow(maker)
        package = next((maker.folder / "couplet/build").glob("*.deb"))
    elif sys.argv[3:]:
        package = pathlib.Path(sys.argv[3])
    else:
        subprocess.run(["cpack", "-B", folder / "deb"], cwd=build, check=True, capture_output=True)
        package = next((folder / "deb").glob("*.deb"))
    depends = subprocess.run(["dpkg", "-f", package, "Depends"], capture_output=True, text=True).stdout
    check("the package names the libraries that it needs", all(name in depends for name in ("libpetsc", "libopenmpi", "libhdf5", "python3-yaml")), depends)
    system = System(folder / "system", base)
    user, entry = make(system, second, package)
    used(system, user, entry)
    joined(system, user, entry)
    removed(system)
end()
