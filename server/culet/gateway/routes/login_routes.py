"""POST /api/login: a browser that was opened with the server's token keeps a cookie in its place."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from culet.gateway.admission.access import ALL, LOGIN_PATH, cookie_name
from culet.gateway.answers.problems import answers
from culet.gateway.identity.server_token import Token
from culet.gateway.routes.parts import ThisGateway
from culet.gateway.state import Gateway

router = APIRouter(tags=["login"])


@router.post(LOGIN_PATH, status_code=204, responses=answers(401, 429))
async def login(request: Request, gateway: ThisGateway) -> Response:
    """Have a cookie in the place of the token, which is to be in the header `Authorization: Bearer ...`.

    No script can read the cookie, and no other site's page has it sent along. Where there is no token there is none.
    """
    response = Response(status_code=204)
    token = gateway.settings.token
    if token is not None and request.state.rights == ALL:
        response.set_cookie(
            cookie_name(request.scope),
            Token(token).cookie,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
            path=_folder(gateway),
        )
    return response


@router.delete(LOGIN_PATH, status_code=204, responses=answers(401, 429))
async def logout(request: Request, gateway: ThisGateway) -> Response:
    """Forget the cookie."""
    response = Response(status_code=204)
    response.delete_cookie(cookie_name(request.scope), path=_folder(gateway), httponly=True, samesite="strict")
    return response


def _folder(gateway: Gateway) -> str:
    """Of the site that a browser tells the cookie to: the others in it may be other people's servers."""
    return f"{gateway.settings.root_path}/"
