"""What can go wrong, as one small tree::

    CuletError
    ├── InputError              the caller sent something that cannot be used; says what was expected and what came
    │   ├── SceneError          a scene, or a part of one
    │   ├── MeshError           a mesh or a cut that is not a stone
    │   └── TooLargeError       more than a configured limit
    ├── ForbiddenError          who asks may not do that
    ├── NotFoundError           no such session, mesh or state
    ├── BusyError               a queue or a number of sessions is at its limit
    ├── EngineUnavailableError  the render process does not answer
    ├── LeavingError            the server is about to be stopped
    ├── WorkersError            workers of a batch that are lost, of another version, or not to be reached
    ├── SolverUnavailableError  no compiled solver, and no compiler to make one
    └── DeviceError             no OpenCL device that works, or a kernel that does not build
        └── KernelCacheError    the driver cannot write the programs that it compiles

Each class knows its HTTP status and the title of its problem document (RFC 9457).
"""


class CuletError(Exception):
    """Base of every error that culet raises on purpose."""

    status = 500
    title = "internal error"


class InputError(CuletError):
    """Input that cannot be used. `field` names the place, such as `camera.fov_degrees`."""

    status = 422
    title = "unusable input"

    def __init__(self, message: str, field: str | None = None) -> None:
        super().__init__(message)
        self.field = field


class SceneError(InputError):
    """A scene, or a part of one, that cannot be used."""

    title = "unusable scene"


class MeshError(InputError):
    """A mesh or a cut that is not a stone; the message names the defect."""

    title = "unusable mesh"


class TooLargeError(InputError):
    """More than a configured limit allows."""

    status = 413
    title = "too large"


class ForbiddenError(CuletError):
    """Who asks may not do that; says who may."""

    status = 403
    title = "forbidden"


class NotFoundError(CuletError):
    """No such session, mesh or state."""

    status = 404
    title = "not found"


class BusyError(CuletError):
    """A queue or a number of sessions is at its limit; try again later."""

    status = 429
    title = "at the limit"


class EngineUnavailableError(CuletError):
    """The render process does not answer."""

    status = 503
    title = "engine unavailable"


class LeavingError(CuletError):
    """The server is about to be stopped, and takes nothing new."""

    status = 503
    title = "server is being stopped"


class WorkersError(CuletError):
    """Workers of a batch, or their scheduler, that are lost, of another version, or not to be reached; says which."""

    status = 503
    title = "workers unavailable"


class SolverUnavailableError(CuletError):
    """No compiled solver of stones in contact, and no compiler to make one; says what is missing and what to do."""

    status = 503
    title = "no solver of stones in contact"


class DeviceError(CuletError):
    """No OpenCL device that works, or a kernel that does not build."""

    status = 500
    title = "no working OpenCL device"


class KernelCacheError(DeviceError):
    """The driver cannot write the programs that it compiles; says which folder, why, and what to do."""

    status = 503
    title = "cannot compile"
