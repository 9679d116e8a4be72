#!/bin/sh
# Runs a command of Cargo in the environment in which maturin calls it, once maturin has. Cargo compiles PyO3, and all that needs it,
# again whenever that environment is another one.
set -e
root=$(cd "$(dirname "$0")/../.." && pwd)
python=$root/.venv/bin/python
if [ -x "$python" ]; then
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    for config in "$root"/target/maturin/pyo3-config-*-"$version"-*.txt; do
        [ -e "$config" ] || continue
        export PYO3_CONFIG_FILE="$config" PYO3_ENVIRONMENT_SIGNATURE="cpython-$version-64bit" PYO3_BUILD_EXTENSION_MODULE=1
        export PYO3_PYTHON="$python" PYTHON_SYS_EXECUTABLE="$python" VIRTUAL_ENV="$root/.venv" PATH="$root/.venv/bin:$PATH"
        break
    done
fi
exec "$@"
