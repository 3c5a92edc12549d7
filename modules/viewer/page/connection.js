// The socket: takes what the program sends, and goes on trying when it is gone.

class Connection {
  /// `receive` gets each message; `changed` whether there is a connection.
  constructor(receive, changed) {
    Object.assign(this, {receive, changed});
    this.open();
  }
  open() {
    const address = new URL('socket' + location.search, location.href.replace(/^http/, 'ws').replace(/#.*$/, ''));
    this.socket = new WebSocket(address);
    this.socket.binaryType = 'arraybuffer';
    this.isFirst = true;
    this.socket.addEventListener('message', (event) => {
      this.receive(decodeMessage(event.data), this.isFirst);
      this.isFirst = false;
    });
    this.socket.addEventListener('open', () => this.changed(true));
    this.socket.addEventListener('close', () => {
      this.changed(false);
      setTimeout(() => this.open(), 1000);
    });
  }
  send(text) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(text);
  }
}
