/** The bitmap of a decoded picture, which is closed: what is shown later is made the same way. */
export function bitmapOf(picture: VideoFrame): ImageBitmap {
  const { displayWidth: width, displayHeight: height } = picture;
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d", { alpha: false });
  if (!context) throw new Error("expected a 2D canvas, got none from this browser");
  context.drawImage(picture, 0, 0, width, height);
  picture.close();
  return canvas.transferToImageBitmap();
}
